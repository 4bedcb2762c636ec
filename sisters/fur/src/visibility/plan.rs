//! How many layers each object gets, by its size and by a budget.

use crate::error::{Error, range};
use crate::numeric::{FLAT_FUR, LAYER_GAP, MAX_LAYERS, PIXELS_PER_VERTEX};

/// A length in the picture: `length` world units at `distance`, in pixels. `focal` is the number of
/// pixels under which a length at its own distance appears, `height / (2 tan(field_of_view / 2))`.
/// At distance 0 or below it is infinite.
pub fn pixels_of(length: f32, distance: f32, focal: f32) -> f32 {
    if length <= 0.0 { 0.0 } else { (length / distance.max(0.0)) * focal }
}

/// The layers that fur so high in the picture needs: one for each 1.5 pixels, so that gaps between
/// layers stay below two pixels, at most `most`. Fur below half a pixel needs none: the base mesh
/// shows its colour.
fn layers_for(height: f32, most: u32) -> u32 {
    let most = most.min(MAX_LAYERS);
    if height < FLAT_FUR || most == 0 {
        return 0;
    }
    let wanted = (height / LAYER_GAP).ceil();
    if wanted.is_nan() { most } else { (wanted as u32).clamp(1, most) }
}

/// The level of detail for an object that covers about `pixels` pixels: the coarsest whose vertices
/// are, on average, four pixels apart. `vertices` are those of the levels, finest first; with none
/// the result is 0.
pub fn level_for(pixels: f32, vertices: &[u32]) -> usize {
    let fine = |&n: &u32| n as f32 >= pixels / PIXELS_PER_VERTEX;
    vertices.iter().rposition(fine).unwrap_or(0)
}

/// How [`plan_layers`] plans.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanOptions {
    /// Pixels under which a length at its own distance appears, as in [`pixels_of`].
    pub focal: f32,
    /// The pixels of the whole picture: no object covers more.
    pub screen: f32,
    /// The most layers of an object, at most 256.
    pub most_layers: u32,
    /// The greatest sum of weights; infinite for no limit.
    pub budget: f64,
    /// The weight of a pixel, where a vertex weighs 1.
    pub pixel_weight: f64,
}

/// An object as a picture sees it, for [`plan_layers`]: distance and size are as in
/// [`casca::DrawItem`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    /// The vertices of its mesh.
    pub vertices: u32,
    /// The height of its fur in world units; 0 for objects without fur.
    pub height: f32,
    /// From the eye to its nearest point, in world units.
    pub distance: f32,
    /// The angle in radians under which it is seen.
    pub size: f32,
}

/// Gives each object of a list, nearest first ([`casca::Pvs::draw_list`]), its layers of fur above
/// the base mesh, in the same order; 0 is the base alone.
///
/// Without a budget, layers follow from the projected height of the fur. The base and each layer
/// weigh their vertices and pixels. A budget takes layers from all objects by the same factor; furry
/// objects keep one layer each. Then the farthest lose this one. The bases stay, even if they alone
/// are too much. What is left over of the budget goes to the nearest. The result depends on nothing
/// but the arguments. Costs some fifty passes over the list if there is a budget.
///
/// # Errors
/// Refuses options that are negative or NaN.
pub fn plan_layers(sights: &[Sight], options: &PlanOptions) -> Result<Vec<u32>, Error> {
    range("the focal length in pixels", options.focal.into(), 0.0, f64::MAX)?;
    range("the pixels of the picture", options.screen.into(), 0.0, f64::MAX)?;
    range("the weight of a pixel", options.pixel_weight, 0.0, f64::MAX)?;
    range("the budget", options.budget, 0.0, f64::INFINITY)?;
    let wish = |item: &Sight| {
        let size = pixels_of(1.0, 1.0, options.focal) * item.size;
        // A disc of this diameter; NaN and more than the picture count as the picture.
        let covered = (size * size * std::f32::consts::FRAC_PI_4).min(options.screen);
        Wish {
            layers: layers_for(pixels_of(item.height, item.distance, options.focal), options.most_layers),
            pass: f64::from(item.vertices) + options.pixel_weight * f64::from(covered),
        }
    };
    Ok(fit(&sights.iter().map(wish).collect::<Vec<_>>(), options.budget))
}

/// What an object would get without a budget.
struct Wish {
    layers: u32,
    /// The weight of the base, and of each layer.
    pass: f64,
}

impl Wish {
    /// The layers at a factor; one is left of any.
    fn scaled(&self, factor: f64) -> u32 {
        ((f64::from(self.layers) * factor) as u32).max(self.layers.min(1))
    }
}

/// Steps of the bisection: 256 layers are told apart after 8, and sums of many objects soon after.
const STEPS: usize = 40;

fn fit(wishes: &[Wish], budget: f64) -> Vec<u32> {
    let total = |layers: &dyn Fn(&Wish) -> u32| -> f64 {
        wishes.iter().map(|w| w.pass * (1.0 + f64::from(layers(w)))).sum()
    };
    if total(&|w| w.layers) <= budget {
        return wishes.iter().map(|w| w.layers).collect();
    }
    let mut layers = vec![0; wishes.len()];
    let mut used = total(&|_| 0);
    if total(&|w| w.scaled(0.0)) <= budget {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..STEPS {
            let middle = 0.5 * (low + high);
            if total(&|w| w.scaled(middle)) <= budget { low = middle } else { high = middle }
        }
        layers = wishes.iter().map(|w| w.scaled(low)).collect();
        used = total(&|w| w.scaled(low));
    }
    // What is left over, to the nearest first: a layer each.
    for (wish, n) in wishes.iter().zip(&mut layers) {
        if *n < wish.layers && used + wish.pass <= budget {
            used += wish.pass;
            *n += 1;
        }
    }
    layers
}

#[cfg(test)]
mod tests {
    use super::*;
    use casca_scenes::random::Dice;

    /// A picture of 1280 x 720 pixels with a vertical angle of 60 degrees, and no budget.
    fn usual() -> PlanOptions {
        let (focal, screen) = (360.0 * 3f32.sqrt(), 1280.0 * 720.0);
        PlanOptions { focal, screen, most_layers: 32, budget: f64::INFINITY, pixel_weight: 1.0 }
    }

    /// Some balls in a row: the nearest at distance 1, the next at distance 2, and so on.
    fn list(count: usize) -> Vec<Sight> {
        let sight = |i: usize| Sight {
            vertices: 4000,
            height: 0.1,
            distance: 1.0 + i as f32,
            size: 2.0 * (1.0 / (2.0 + i as f32)).asin(),
        };
        (0..count).map(sight).collect()
    }

    /// The weight of so many layers of each, and their bases.
    fn weight(sights: &[Sight], layers: impl IntoIterator<Item = u32>) -> f64 {
        let pass = |s: &Sight| {
            let size = usual().focal * s.size;
            4000.0 + f64::from((size * size * std::f32::consts::FRAC_PI_4).min(usual().screen))
        };
        sights.iter().zip(layers).map(|(s, n)| pass(s) * f64::from(n + 1)).sum()
    }

    #[test]
    fn layers_follow_height_and_levels_size() {
        assert_eq!(
            [0.0, 0.49, 0.5, 3.0, 24.0, 1e9, f32::INFINITY].map(|h| layers_for(h, 32)),
            [0, 0, 1, 2, 16, 32, 32]
        );
        // Doubt draws more.
        assert_eq!(layers_for(f32::NAN, 32), 32);
        assert_eq!((layers_for(24.0, 0), layers_for(1e9, u32::MAX)), (0, MAX_LAYERS));
        assert_eq!(pixels_of(0.5, 10.0, 600.0), 30.0);
        assert_eq!((pixels_of(0.5, 0.0, 600.0), pixels_of(0.0, 0.0, 600.0)), (f32::INFINITY, 0.0));
        let levels = [4000, 1000, 250];
        assert_eq!([1e9, 64_000.0, 16_000.0, 4000.0, 0.0].map(|p| level_for(p, &levels)), [0, 0, 1, 2, 2]);
        assert_eq!((level_for(100.0, &[]), level_for(f32::NAN, &levels)), (0, 0));
    }

    #[test]
    fn budgets_take_layers_by_the_same_factor_and_leave_one_each_while_they_can() {
        let (sights, mut random) = (list(300), Dice::new(8, 0));
        let free = plan_layers(&sights, &usual()).unwrap();
        assert!(free.is_sorted_by(|a, b| a >= b) && (free[0], free[299]) == (32, 0), "{free:?}");
        let all = weight(&sights, free.clone());
        let one_each = weight(&sights, free.iter().map(|n| *n.min(&1)));
        let bases = weight(&sights, vec![0; 300]);
        for step in 0..60 {
            let budget = all * (f64::from(step) / 50.0 + 0.01 * f64::from(random.range(0.0, 1.0)));
            let options = PlanOptions { budget, ..usual() };
            let plan = plan_layers(&sights, &options).unwrap();
            let used = weight(&sights, plan.clone());
            assert_eq!(used > budget * (1.0 + 1e-6), bases > budget, "step {step}");
            if bases > budget {
                assert!(plan.iter().all(|n| *n == 0), "step {step}");
            } else {
                assert!(budget >= all || used > 0.8 * budget, "step {step}");
            }
            if budget >= all {
                assert_eq!(plan, free);
            }
            if budget >= one_each {
                assert!(plan.iter().zip(&free).all(|(n, f)| *n >= *f.min(&1)), "step {step}");
            }
        }
    }

    #[test]
    fn odd_lists_do_no_harm_and_odd_options_are_refused() {
        let mut sights = list(4);
        sights.iter_mut().for_each(|s| (s.vertices, s.height) = (0, f32::NAN));
        (sights[0].distance, sights[0].size) = (0.0, f32::INFINITY);
        (sights[1].distance, sights[1].size) = (f32::NAN, f32::NAN);
        sights[2].distance = f32::NEG_INFINITY;
        for budget in [0.0, 1e5, 1e9, f64::INFINITY] {
            let plan = plan_layers(&sights, &PlanOptions { budget, ..usual() }).unwrap();
            assert!(plan.len() == 4 && plan.iter().all(|n| *n <= 32));
            assert!(plan_layers(&[], &PlanOptions { budget, ..usual() }).unwrap().is_empty());
        }
        for options in [
            PlanOptions { focal: f32::NAN, ..usual() },
            PlanOptions { screen: -1.0, ..usual() },
            PlanOptions { budget: f64::NAN, ..usual() },
            PlanOptions { pixel_weight: f64::INFINITY, ..usual() },
        ] {
            assert!(matches!(plan_layers(&sights, &options), Err(Error::Range { .. })));
        }
    }
}
