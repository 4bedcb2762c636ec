//! The images of a mesh on the device: layers of one texture, with smaller copies.

use casca_stage::gpu::{Gpu, GpuError};
use casca_stage::kernel::filled;
use casca_stage::wgpu::{
    self, BindingResource, BindingType, BufferUsages, ShaderStages, TextureFormat, TextureSampleType,
    TextureViewDimension,
};
use casca_tools::image::srgb;
use glam::{UVec2, Vec3};

use crate::error::{Error, range};
use crate::gpu::bindings::{self, UNIFORM, texture};
use crate::gpu::numeric::{DRAWN_BYTES, DRAWN_SIDE};
use crate::mesh::{Image, Wrap};
use crate::numeric::MAX_IMAGES;

/// The layout of the images of a mesh.
pub(super) fn layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let float = TextureSampleType::Float { filterable: true };
    let sampler = BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
    let types = [texture(float, TextureViewDimension::D2Array), sampler, UNIFORM];
    bindings::layout(device, ShaderStages::FRAGMENT, &types)
}

/// The images of a mesh for the shaders; with none, meshes have the colours of their coats.
pub(super) fn group(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    images: &[Image],
) -> Result<wgpu::BindGroup, GpuError> {
    use wgpu::util::DeviceExt;
    let device = &gpu.device;
    let size = layer_size(images, device.limits().max_texture_dimension_2d);
    let layers = images.len().max(1) as u32;
    let (mut texels, mut levels) = (Vec::new(), 1);
    for image in images {
        let chain = smaller_copies(fitted(image, size), size);
        levels = chain.len() as u32;
        texels.extend(chain.concat());
    }
    texels.resize(texels.len().max(4), 255);
    let drawn = device.create_texture_with_data(
        &gpu.queue,
        &wgpu::TextureDescriptor {
            label: Some("images"),
            size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: layers },
            mip_level_count: levels,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: TextureFormat::Rgba8UnormSrgb,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        },
        wgpu::util::TextureDataOrder::LayerMajor,
        &texels,
    );
    let mut wraps = [[0u32; 4]; MAX_IMAGES as usize];
    for (row, image) in wraps.iter_mut().zip(images) {
        let [u, v] = image.wrap().map(|wrap| match wrap {
            Wrap::Repeat => 0,
            Wrap::Clamp => 1,
            Wrap::Mirror => 2,
        });
        *row = [u, v, 0, 0];
    }
    wraps[0][2] = images.len() as u32;
    let uniform = filled(gpu, &wraps, BufferUsages::UNIFORM)?;
    let view = drawn.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    });
    let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
        address_mode_u: wgpu::AddressMode::Repeat,
        address_mode_v: wgpu::AddressMode::Repeat,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    });
    let resources = [
        BindingResource::TextureView(&view),
        BindingResource::Sampler(&sampler),
        uniform.as_entire_binding(),
    ];
    Ok(bindings::group(device, layout, resources))
}

/// Refuses more images than a mesh may have.
pub(super) fn check(images: &[Image]) -> Result<(), Error> {
    range("the number of images", images.len() as f64, 0.0, MAX_IMAGES.into())
}

/// The size of all layers: that of the largest image, but no side is longer than `most` or
/// [`DRAWN_SIDE`], and all layers have at most [`DRAWN_BYTES`].
fn layer_size(images: &[Image], most: u32) -> UVec2 {
    let largest = images.iter().fold(UVec2::ONE, |size, image| size.max(image.size()));
    let mut size = largest.min(UVec2::splat(DRAWN_SIDE.min(most)));
    while 4 * u64::from(size.x) * u64::from(size.y) * images.len() as u64 > DRAWN_BYTES {
        size = (size / 2).max(UVec2::ONE);
    }
    size
}

/// The texels of an image at another size.
fn fitted(image: &Image, size: UVec2) -> Vec<u8> {
    // The mean of whole blocks first: else texels between the places that are looked up are lost.
    let (mut texels, mut now) = (image.texels().to_vec(), image.size());
    while now.x >= 2 * size.x || now.y >= 2 * size.y {
        let next = UVec2::new(
            if now.x >= 2 * size.x { now.x / 2 } else { now.x },
            if now.y >= 2 * size.y { now.y / 2 } else { now.y },
        );
        (texels, now) = (shrunk(&texels, now, next), next);
    }
    if now == size {
        return texels;
    }
    let Ok(image) = Image::new(now, texels, image.wrap()) else {
        return vec![255; 4 * size.element_product() as usize];
    };
    let places = (0..size.y).flat_map(|y| (0..size.x).map(move |x| UVec2::new(x, y)));
    places.flat_map(|at| stored(image.color((at.as_vec2() + 0.5) / size.as_vec2()))).collect()
}

/// An image and its copies, each half as wide and high as the one before.
fn smaller_copies(texels: Vec<u8>, mut size: UVec2) -> Vec<Vec<u8>> {
    let mut copies = vec![texels];
    while size.max_element() > 1 {
        let next = (size / 2).max(UVec2::ONE);
        let copy = copies.last().map(|texels| shrunk(texels, size, next));
        copies.extend(copy);
        size = next;
    }
    copies
}

/// Half or all of the width and height: the mean of the texels in each block, in linear light.
fn shrunk(texels: &[u8], from: UVec2, to: UVec2) -> Vec<u8> {
    let step = from / to;
    let mut made = Vec::with_capacity(4 * to.element_product() as usize);
    for y in 0..to.y {
        for x in 0..to.x {
            let mut sum = Vec3::ZERO;
            for (dx, dy) in (0..step.y).flat_map(|dy| (0..step.x).map(move |dx| (dx, dy))) {
                let at = 4 * ((y * step.y + dy) * from.x + x * step.x + dx) as usize;
                sum += Image::linear(&texels[at..at + 4]);
            }
            made.extend(stored(sum / step.element_product() as f32));
        }
    }
    made
}

/// Linear light as four bytes of sRGB.
fn stored(light: Vec3) -> [u8; 4] {
    [srgb(light.x), srgb(light.y), srgb(light.z), 255]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(size: UVec2, texel: impl Fn(u32, u32) -> u8) -> Image {
        let places = (0..size.y).flat_map(|y| (0..size.x).map(move |x| (x, y)));
        let texels = places.flat_map(|(x, y)| [texel(x, y), texel(x, y), texel(x, y), 255]).collect();
        Image::new(size, texels, [Wrap::Clamp; 2]).unwrap()
    }

    #[test]
    fn copies_are_means_of_light_and_all_layers_have_one_size() {
        // Black and white in turns: 188 is half of the light in sRGB, 128 is not.
        let board = image(UVec2::new(8, 4), |x, y| 255 * ((x + y) % 2) as u8);
        let copies = smaller_copies(board.texels().to_vec(), board.size());
        assert_eq!(copies.iter().map(Vec::len).collect::<Vec<_>>(), [128, 32, 8, 4]);
        assert!(copies[1..].iter().all(|copy| copy.chunks(4).all(|t| t == [188, 188, 188, 255])));
        let plain = image(UVec2::new(3, 5), |_, _| 77);
        assert_eq!(layer_size(&[board.clone(), plain.clone()], 8192), UVec2::new(8, 5));
        for size in [UVec2::new(8, 5), UVec2::ONE, UVec2::new(2, 1)] {
            let made = fitted(&plain, size);
            assert_eq!(made.len(), 4 * size.element_product() as usize);
            assert!(made.chunks(4).all(|t| t == [77, 77, 77, 255]), "{size}");
        }
        assert!(fitted(&board, UVec2::ONE).starts_with(&[188, 188, 188]), "no texel is passed over");
        let every: Vec<u8> = (0..=255).collect();
        assert!(every.iter().all(|&b| stored(Image::linear(&[b, b, b, 0]))[0] == b), "no byte changes");
    }

    #[test]
    fn layers_keep_within_their_bytes() {
        let wide = image(UVec2::new(4096, 1), |_, _| 0);
        assert_eq!(layer_size(std::slice::from_ref(&wide), 16_384), UVec2::new(DRAWN_SIDE, 1));
        assert_eq!(layer_size(&[wide], 1024), UVec2::new(1024, 1));
        let square = image(UVec2::splat(2048), |_, _| 0);
        let size = layer_size(&vec![square; 64], 16_384);
        assert!(64 * 4 * u64::from(size.element_product()) <= DRAWN_BYTES && size.x >= 512, "{size}");
        assert_eq!(layer_size(&[], 8192), UVec2::ONE);
    }
}
