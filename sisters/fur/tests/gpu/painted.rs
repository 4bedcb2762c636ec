//! Fur coloured by images: shells beside rays that take the colour at each strand's root.

use casca_fur::gpu::look::Look;
use casca_fur::gpu::records::{DrawList, Stand, Sun};
use casca_fur::gpu::reference::Reference;
use casca_fur::gpu::renderer::Renderer;
use casca_fur::mesh::{Coat, Image, Mesh, TexCoord, Vertex, Wrap};
use casca_fur::shading::Material;
use casca_fur::strands::Fur;
use casca_stage::canvas::Canvas;
use casca_stage::gpu::{COLOUR, Gpu};
use casca_tools::camera::Camera;
use glam::{Affine3A, UVec2, Vec2, Vec3};

const TO_SUN: Vec3 = Vec3::new(0.6, 0.64, 0.48);
const SIZE: (u32, u32) = (96, 72);

/// A ball of radius 1 whose place on image 0 is its shadow on the plane z = 0: two images in each
/// direction, and half of one more.
fn ball() -> Mesh {
    let mesh = crate::ball(3, |_| Coat::default());
    let place = |v: &Vertex| Vec2::new(v.position.x, -v.position.y) * 1.25 + 1.25;
    let places = mesh.vertices().iter().map(|v| TexCoord { uv: place(v), image: Some(0) }).collect();
    mesh.with_tex_coords(places).unwrap()
}

/// Four stripes of an image: red, sRGB 128, blue, white; darker below.
fn stripes(wrap: Wrap) -> Image {
    let texel = |x: u32, y: u32| {
        let [r, g, b] = [[220, 30, 20], [128; 3], [20, 40, 200], [250; 3]][(x / 8) as usize];
        if y < 16 { [r, g, b, 255] } else { [r / 2, g / 2, b / 2, 0] }
    };
    let texels = (0..32).flat_map(|y| (0..32).flat_map(move |x| texel(x, y))).collect();
    Image::new(UVec2::splat(32), texels, [wrap; 2]).unwrap()
}

fn camera() -> Camera {
    Camera::look_at(Vec3::new(0.5, 0.4, 3.0), Vec3::ZERO, 40.0, 4.0 / 3.0, 0.1, 20.0)
}

/// The picture of shells.
fn shells(gpu: &Gpu, renderer: &mut Renderer, layers: u32) -> Vec<u8> {
    let canvas = Canvas::new(gpu, (2 * SIZE.0, 2 * SIZE.1));
    let stand = Stand { mesh: 0, place: Affine3A::IDENTITY, root: [1.0; 3], tip: [1.0; 3] };
    let list = DrawList::new(&[(stand, layers)], Vec::new());
    let sun = Sun { towards: TO_SUN, center: Vec3::ZERO, radius: 2.0, shadows: false };
    renderer.draw(gpu, &canvas.picture(), &camera(), &list, &sun).unwrap();
    casca_tools::image::halved(&canvas.read_picture(gpu).unwrap(), canvas.size())
}

fn rmse(a: &[u8], b: &[u8]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2)).sum();
    (sum / a.len() as f64).sqrt() / 255.0
}

#[test]
fn bare_skin_has_the_colours_of_its_image_however_it_goes_on() {
    let Some(gpu) = Gpu::for_tests() else { return };
    // Light from everywhere, and no fur: a pixel is a texel.
    let material =
        Material { ambient: 1.0, diffuse: 0.0, specular: 0.0, exponent: 1.0, wrap: 0.0, root: 1.0 };
    let look = Look { material, ..Look::new(Fur::for_radius(1.0, 0.05, 0.3).unwrap()) };
    let mesh = ball();
    let mut pictures = Vec::new();
    for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
        let images = [stripes(wrap)];
        let mut renderer = Renderer::new(&gpu, COLOUR, std::slice::from_ref(&mesh), &look).unwrap();
        renderer.set_images(&gpu, &[0], &images).unwrap();
        let reference = Reference::new(&mesh, &look).unwrap().with_images(&images);
        let bald = mesh.clone().with_coats(|_| Coat { length: 0.0, ..Coat::default() }).unwrap();
        let bare = Reference::new(&bald, &look).unwrap().with_images(&images);
        assert!(reference.strands() > 0 && bare.strands() == 0);
        let mut drawn = Renderer::new(&gpu, COLOUR, std::slice::from_ref(&bald), &look).unwrap();
        drawn.set_images(&gpu, &[0], &images).unwrap();
        let [want, got] =
            [bare.picture(&camera(), SIZE, 2, &[Vec3::ONE; 2], TO_SUN), shells(&gpu, &mut drawn, 0)];
        let error = rmse(&want, &got);
        println!("{wrap:?}: RMSE of bare skin {error:.4}");
        assert!(error < 0.02, "{wrap:?}: {error}");
        pictures.push(got);
    }
    let apart = [(0, 1), (1, 2), (0, 2)].map(|(a, b)| rmse(&pictures[a], &pictures[b]));
    assert!(apart.iter().all(|&d| d > 0.05), "the three ways differ: {apart:?}");
}

#[test]
fn shells_have_the_colours_of_roots() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let mesh = ball();
    let images = [stripes(Wrap::Repeat)];
    let mut fur = Fur { spacing: 0.1, ..Fur::for_radius(1.0, 0.2, 0.4).unwrap() };
    fur.bend = Vec3::new(0.3, -0.5, 0.0);
    let look = Look { vary: 0.0, ..Look::new(fur) };
    let reference = Reference::new(&mesh, &look).unwrap().with_images(&images);
    let want = reference.picture(&camera(), SIZE, 2, &[Vec3::ONE; 2], TO_SUN);
    let mut renderer = Renderer::new(&gpu, COLOUR, std::slice::from_ref(&mesh), &look).unwrap();
    let plain = rmse(&want, &shells(&gpu, &mut renderer, 32));
    renderer.set_images(&gpu, &[0], &images).unwrap();
    let errors = [4, 12, 32].map(|layers| rmse(&want, &shells(&gpu, &mut renderer, layers)));
    println!("RMSE with 4, 12 and 32 layers: {errors:.4?}, without the image {plain:.4}");
    assert!(errors.is_sorted_by(|a, b| a > b) && errors[2] < ROOTS && plain > 0.15, "{errors:?} {plain}");
}

/// Colours below fragments instead of those of roots err by 0.0447.
const ROOTS: f64 = 0.041;

#[test]
fn strange_images_end_no_device() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let look = Look::new(Fur::for_radius(1.0, 0.1, 0.3).unwrap());
    let mesh = [ball()];
    let mut renderer = Renderer::new(&gpu, COLOUR, &mesh, &look).unwrap();
    // Meshes without images have shaders of their own; an image that is not there is white.
    let white = shells(&gpu, &mut renderer, 2);
    let one = |x: u32, y: u32, byte: u8| {
        Image::new(UVec2::new(x, y), vec![byte; 4 * (x * y) as usize], [Wrap::Mirror; 2]).unwrap()
    };
    renderer.set_images(&gpu, &[0], &[one(1, 1, 255), one(16_384, 1, 7)]).unwrap();
    assert_eq!(shells(&gpu, &mut renderer, 2), white);
    renderer.set_images(&gpu, &[0], &[]).unwrap();
    assert_eq!(shells(&gpu, &mut renderer, 2), white);
    assert!(renderer.set_images(&gpu, &[0, 1], &[]).is_err());
    assert!(renderer.set_images(&gpu, &[0], &vec![one(1, 1, 0); 65]).is_err());
    renderer.set_images(&gpu, &[0], &vec![one(1, 1, 0); 64]).unwrap();
    assert!(rmse(&shells(&gpu, &mut renderer, 2), &white) > 0.1);
}
