export * from "./casca.js";
/** Makes casca ready, from WebAssembly inside this module: for bundlers and hosts that serve no `.wasm` files. */
export default function init(): Promise<unknown>;
