//! Memory for the library in C++ that simplifies meshes: what `new` and `delete` of C++ call. This
//! target has no library of C++ that would.

use std::alloc::{Layout, alloc, dealloc, handle_alloc_error};

/// Bytes before each block, which hold its size; `new` promises blocks aligned by as much.
const HEAD: usize = 16;

fn layout(bytes: usize) -> Layout {
    let whole = bytes.saturating_add(HEAD);
    // A size that there is no layout for is one that there is no memory for.
    Layout::from_size_align(whole, HEAD).unwrap_or_else(|_| handle_alloc_error(Layout::new::<[u8; HEAD]>()))
}

/// `operator new(size_t)`.
#[allow(unsafe_code)]
#[unsafe(export_name = "_Znwm")]
extern "C" fn new(bytes: usize) -> *mut u8 {
    let layout = layout(bytes);
    // SAFETY: the layout has a size, of the head at least; the head is written within the block, at
    // its start, which is aligned for it.
    unsafe {
        let block = alloc(layout);
        if block.is_null() {
            handle_alloc_error(layout);
        }
        block.cast::<usize>().write(bytes);
        block.add(HEAD)
    }
}

/// `operator delete(void*)`.
#[allow(unsafe_code)]
#[unsafe(export_name = "_ZdlPv")]
extern "C" fn delete(at: *mut u8) {
    if at.is_null() {
        return;
    }
    // SAFETY: C++ gives back only what `new` gave it, once: the head before it holds the size that
    // it was allocated with.
    unsafe {
        let block = at.sub(HEAD);
        dealloc(block, layout(block.cast::<usize>().read()));
    }
}
