// The colour of a strand: that of the coat and of an image at its root. As to the comment "images" see shells.wgsl.

// Images of the mesh, all of one size.
@group(2) @binding(0) var images: texture_2d_array<f32>;
@group(2) @binding(1) var image_sampler: sampler;
// How each image goes on along u and v: 0 repeated, 1 clamped, 2 mirrored. The z of the first is their number.
@group(2) @binding(2) var<uniform> wraps: array<vec4u, 64>;

/// How the coat and the place on the image change from pixel to pixel.
struct Paint {
    coat: array<vec3f, 2>,
    tex: array<vec2f, 2>, // images
}

/// Must be called by all fragments.
fn paint_of(shell: Shell) -> Paint {
    let coat = shell.coat.rgb;
    var paint: Paint;
    paint.coat = array(dpdx(coat), dpdy(coat));
    paint.tex = array(dpdx(shell.tex), dpdy(shell.tex)); // images
    return paint;
}

/// A coordinate within the image; `rim` is half of the width over which the sampler mixes.
fn inside_image(x: f32, wrap: u32, rim: f32) -> f32 {
    switch wrap {
        case 1u: { return clamp(x, rim, 1.0 - rim); }
        case 2u: { return clamp(1.0 - abs(2.0 * fract(0.5 * x) - 1.0), rim, 1.0 - rim); }
        default: { return x; }
    }
}

/// The linear colour of an image, numbered from 1; white for image 0.
fn image_colour(uv: vec2f, image: u32, dx: vec2f, dy: vec2f) -> vec3f {
    if image == 0u || image > wraps[0].z {
        return vec3f(1.0);
    }
    let size = vec2f(textureDimensions(images));
    let wrap = wraps[image - 1u].xy;
    let wide = max(1.0, max(length(dx * size), length(dy * size)));
    let rim = min(0.5 * wide / size, vec2f(0.5));
    let at = vec2f(inside_image(uv.x, wrap.x, rim.x), inside_image(uv.y, wrap.y, rim.y));
    return textureSampleGrad(images, image_sampler, at, image - 1u, dx, dy).rgb;
}

/// The colour at a place on the skin, `way` from the base of the fragment.
fn colour_at(shell: Shell, c: Change, paint: Paint, way: vec3f) -> vec3f {
    let across = cross(c.base[0], c.base[1]);
    let area = dot(across, across);
    var pixels = vec2f(0.0);
    if area > 0.0 {
        // Colours do not go on changing so far beyond the triangle.
        let near = way * min(1.0, length(shell.corner - shell.base) / max(length(way), 1e-30));
        pixels = vec2f(dot(near, cross(c.base[1], across)), dot(near, cross(across, c.base[0]))) / area;
    }
    var colour = saturate(shell.coat.rgb + paint.coat[0] * pixels.x + paint.coat[1] * pixels.y);
    let uv = shell.tex + paint.tex[0] * pixels.x + paint.tex[1] * pixels.y; // images
    colour *= image_colour(uv, shell.image, paint.tex[0], paint.tex[1]); // images
    return colour;
}
