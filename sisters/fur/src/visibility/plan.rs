//! How many layers each object gets, by its size, by what can be seen of it, and by a budget.

use crate::error::{Error, range};
use crate::numeric::{FLAT_FUR, LAYER_GAP, MAX_LAYERS, PIXELS_PER_VERTEX};

/// A length in the picture: `length` world units at `distance`, in pixels. `focal` is the number of
/// pixels under which a length at its own distance appears, `height / (2 tan(field_of_view / 2))`.
/// At distance 0 or below it is infinite.
pub fn pixels_of(length: f32, distance: f32, focal: f32) -> f32 {
    if length <= 0.0 { 0.0 } else { (length / distance.max(0.0)) * focal }
}

/// The layers that fur needs: one for each 1.5 pixels of its height, so that gaps between layers
/// stay below two pixels, at most `most`. Fur below half a pixel needs none: the base mesh shows
/// its colour.
///
/// If only the share `fraction` of the object is seen ([`casca::DrawItem::fraction`]), the root of that
/// share of the layers is enough; a share is an estimate, so that one layer is left. NaN counts as
/// all.
pub fn layers_for(height: f32, fraction: f32, most: u32) -> u32 {
    let most = most.min(MAX_LAYERS);
    if height < FLAT_FUR || most == 0 {
        return 0;
    }
    let share = if fraction < 1.0 { fraction.max(0.0).sqrt() } else { 1.0 };
    let wanted = (height / LAYER_GAP * share).ceil();
    if wanted.is_nan() { most } else { (wanted as u32).clamp(1, most) }
}

/// The level of detail for an object that covers about `pixels` pixels: the coarsest whose vertices
/// are, on average, four pixels apart. `vertices` are those of the levels, finest first; with none
/// the result is 0.
pub fn level_for(pixels: f32, vertices: &[u32]) -> usize {
    let fine = |&n: &u32| n as f32 >= pixels / PIXELS_PER_VERTEX;
    vertices.iter().rposition(fine).unwrap_or(0)
}

/// How [`plan_sights`] plans.
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

impl Default for PlanOptions {
    /// A picture of 1280 x 720 pixels with a vertical angle of 60 degrees, 32 layers at most and no
    /// budget.
    fn default() -> Self {
        let (focal, screen) = (360.0 * 3f32.sqrt(), 1280.0 * 720.0);
        Self { focal, screen, most_layers: 32, budget: f64::INFINITY, pixel_weight: 1.0 }
    }
}

/// An object as a picture sees it, for [`plan_sights`]: fields are as in [`casca::DrawItem`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight<'a> {
    /// The vertices of its levels of detail, finest first.
    pub vertices: &'a [u32],
    /// The height of its fur in world units; 0 for objects without fur.
    pub height: f32,
    /// From the eye to its nearest point, in world units.
    pub distance: f32,
    /// The angle in radians under which it is seen.
    pub size: f32,
    /// The share of it that can be seen, 0 to 1: an estimate, which takes layers away.
    pub fraction: f32,
}

/// How one object of [`plan_sights`] is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    /// Its level of detail: 0 is the finest.
    pub level: usize,
    /// Layers of fur above the base mesh; 0 is the base alone.
    pub layers: u32,
    /// Its weight: base and layers, each of them its vertices and its pixels.
    pub weight: f64,
}

/// Gives each object of a list, nearest first ([`casca::Pvs::draw_list`]), its level of detail and
/// its layers, in the same order.
///
/// Without a budget, layers follow from the projected height of the fur ([`layers_for`]) and levels
/// from the projected size ([`level_for`]). A budget takes layers from all objects by the same
/// factor; furry objects keep one layer each. Then the farthest lose this one. If the bases alone
/// are too much, objects become coarser, the one that appears smallest first, until the bases fit;
/// **no object is dropped**, since all of them can be seen, so that the sum of weights is above the
/// budget where all are at their coarsest and still too much. What is left over of the budget goes
/// to the nearest. The result depends on nothing but the arguments. Costs some fifty passes over the
/// list if there is a budget.
///
/// # Errors
/// Refuses options that are negative or NaN.
pub fn plan_sights(sights: &[Sight], options: &PlanOptions) -> Result<Vec<Share>, Error> {
    range("the focal length in pixels", options.focal.into(), 0.0, f64::MAX)?;
    range("the pixels of the picture", options.screen.into(), 0.0, f64::MAX)?;
    range("the weight of a pixel", options.pixel_weight, 0.0, f64::MAX)?;
    range("the budget", options.budget, 0.0, f64::INFINITY)?;
    let wish = |item: &Sight| {
        let size = pixels_of(1.0, 1.0, options.focal) * item.size;
        // A disc of this diameter; NaN and more than the picture count as the picture.
        let covered = (size * size * std::f32::consts::FRAC_PI_4).min(options.screen);
        let level = level_for(covered, item.vertices);
        let vertices = |level: usize| f64::from(item.vertices.get(level).copied().unwrap_or(0));
        // The cheapest of the levels; the finest of those that cost the same.
        let coarsest = (level..item.vertices.len())
            .min_by(|&a, &b| vertices(a).total_cmp(&vertices(b)))
            .unwrap_or(level);
        let seen = if item.fraction < 1.0 { item.fraction.max(0.0) } else { 1.0 };
        let seen_size = item.size * item.fraction.sqrt();
        Wish {
            level,
            coarsest,
            saving: vertices(level) - vertices(coarsest),
            seen_size: if seen_size.is_nan() { f32::INFINITY } else { seen_size },
            layers: layers_for(
                pixels_of(item.height, item.distance, options.focal),
                item.fraction,
                options.most_layers,
            ),
            pass: vertices(level) + options.pixel_weight * f64::from(covered * seen),
        }
    };
    let wishes: Vec<Wish> = sights.iter().map(wish).collect();
    Ok(fit(wishes, options.budget))
}

/// What an object would get without a budget.
struct Wish {
    level: usize,
    /// The level that costs least, and how many vertices less than the other it costs.
    coarsest: usize,
    saving: f64,
    seen_size: f32,
    layers: u32,
    /// The weight of the base, and of each layer.
    pass: f64,
}

impl Wish {
    fn weight(&self, layers: u32) -> f64 {
        self.pass * (1.0 + f64::from(layers))
    }

    /// The layers at a factor; one is left of any.
    fn scaled(&self, factor: f64) -> u32 {
        ((f64::from(self.layers) * factor) as u32).max(self.layers.min(1))
    }
}

/// Steps of the bisection: 256 layers are told apart after 8, and sums of many objects soon after.
const STEPS: usize = 40;

fn fit(mut wishes: Vec<Wish>, budget: f64) -> Vec<Share> {
    let total = |wishes: &[Wish], layers: &dyn Fn(&Wish) -> u32| -> f64 {
        wishes.iter().map(|w| w.weight(layers(w))).sum()
    };
    let mut layers: Vec<u32>;
    if total(&wishes, &|w| w.layers) <= budget {
        layers = wishes.iter().map(|w| w.layers).collect();
    } else if total(&wishes, &|w| w.scaled(0.0)) <= budget {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..STEPS {
            let middle = 0.5 * (low + high);
            if total(&wishes, &|w| w.scaled(middle)) <= budget { low = middle } else { high = middle }
        }
        layers = wishes.iter().map(|w| w.scaled(low)).collect();
    } else {
        coarsen_smallest(&mut wishes, budget);
        layers = vec![0; wishes.len()];
    }
    // What is left over, to the nearest first: a layer each.
    let mut used: f64 = wishes.iter().zip(&layers).map(|(w, &n)| w.weight(n)).sum();
    for (wish, n) in wishes.iter().zip(&mut layers) {
        if *n < wish.layers && used + wish.pass <= budget {
            used += wish.pass;
            *n += 1;
        }
    }
    let shares = wishes.iter().zip(layers);
    shares.map(|(w, n)| Share { level: w.level, layers: n, weight: w.weight(n) }).collect()
}

/// Gives objects their coarsest level, those that appear smallest first, until the bases are within
/// the budget.
fn coarsen_smallest(wishes: &mut [Wish], budget: f64) {
    let mut order: Vec<usize> = (0..wishes.len()).collect();
    // Smallest first; among equals the farthest.
    order.sort_by(|&a, &b| wishes[a].seen_size.total_cmp(&wishes[b].seen_size).then(b.cmp(&a)));
    let mut used: f64 = wishes.iter().map(|w| w.pass).sum();
    for i in order {
        if used <= budget {
            return;
        }
        let wish = &mut wishes[i];
        used -= wish.saving;
        wish.pass -= wish.saving;
        (wish.level, wish.saving) = (wish.coarsest, 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::dice;

    const VERTICES: &[u32] = &[4000, 1000, 250];

    /// Some balls in a row: the nearest at distance 1, the next at distance 2, and so on.
    fn list(count: usize) -> Vec<Sight<'static>> {
        let sight = |i: usize| Sight {
            vertices: VERTICES,
            height: 0.1,
            distance: 1.0 + i as f32,
            size: 2.0 * (1.0 / (2.0 + i as f32)).asin(),
            fraction: 1.0,
        };
        (0..count).map(sight).collect()
    }

    fn weight(shares: &[Share]) -> f64 {
        shares.iter().map(|s| s.weight).sum()
    }

    fn base(share: &Share) -> f64 {
        share.weight / f64::from(1 + share.layers)
    }

    #[test]
    fn layers_follow_height_and_fraction_and_levels_size() {
        assert_eq!(
            [0.0, 0.49, 0.5, 3.0, 24.0, 1e9, f32::INFINITY].map(|h| layers_for(h, 1.0, 32)),
            [0, 0, 1, 2, 16, 32, 32]
        );
        assert_eq!([1.0, 0.25, 0.01, 0.0, -1.0].map(|f| layers_for(24.0, f, 32)), [16, 8, 2, 1, 1]);
        // Doubt draws more.
        assert_eq!((layers_for(f32::NAN, 1.0, 32), layers_for(24.0, f32::NAN, 32)), (32, 16));
        assert_eq!((layers_for(24.0, 1.0, 0), layers_for(1e9, 1.0, u32::MAX)), (0, MAX_LAYERS));
        assert_eq!(pixels_of(0.5, 10.0, 600.0), 30.0);
        assert_eq!((pixels_of(0.5, 0.0, 600.0), pixels_of(0.0, 0.0, 600.0)), (f32::INFINITY, 0.0));
        let levels = [4000, 1000, 250];
        assert_eq!([1e9, 64_000.0, 16_000.0, 4000.0, 0.0].map(|p| level_for(p, &levels)), [0, 0, 1, 2, 2]);
        assert_eq!((level_for(100.0, &[]), level_for(f32::NAN, &levels)), (0, 0));
    }

    #[test]
    fn without_a_budget_everything_gets_what_it_needs() {
        let (sights, options) = (list(200), PlanOptions::default());
        let plan = plan_sights(&sights, &options).unwrap();
        // Farther objects have fewer layers and coarser meshes.
        assert!(plan.is_sorted_by(|a, b| a.layers >= b.layers && a.level <= b.level));
        let (first, last) = (plan[0], plan[199]);
        assert_eq!((first.layers, first.level, last.layers, last.level), (32, 0, 0, 2));
        // Hidden parts take layers away.
        let half: Vec<Sight> = sights.iter().map(|s| Sight { fraction: 0.25, ..*s }).collect();
        let by_fraction = plan_sights(&half, &options).unwrap();
        assert!(by_fraction[0].layers == 21 && weight(&by_fraction) < 0.5 * weight(&plan));
    }

    #[test]
    fn budgets_take_layers_before_levels_and_no_objects() {
        let (sights, mut random) = (list(300), dice(8));
        let free = plan_sights(&sights, &PlanOptions::default()).unwrap();
        let bases: f64 = free.iter().map(base).sum();
        let one_each = bases + free.iter().filter(|s| s.layers > 0).map(base).sum::<f64>();
        let least = |s: &Share| base(s) - f64::from(VERTICES[s.level] - 250);
        let coarsest: f64 = free.iter().map(least).sum();
        for step in 0..60 {
            let budget = weight(&free) * (f64::from(step) / 50.0 + 0.01 * random.next());
            let options = PlanOptions { budget, ..PlanOptions::default() };
            let plan = plan_sights(&sights, &options).unwrap();
            assert_eq!(plan, plan_sights(&sights, &options).unwrap());
            let is_over = weight(&plan) > budget * (1.0 + 1e-6);
            assert_eq!(is_over, coarsest > budget, "step {step}");
            if is_over {
                assert!(plan.iter().all(|s| s.layers == 0 && s.level == 2), "step {step}");
            }
            if bases <= budget {
                assert!(plan.iter().zip(&free).all(|(s, f)| s.level == f.level));
                assert!(budget >= weight(&free) || weight(&plan) > 0.8 * budget, "step {step}");
            }
            if budget >= weight(&free) {
                assert_eq!(plan, free);
            }
            if budget >= one_each {
                assert!(plan.iter().zip(&free).all(|(s, f)| s.layers >= f.layers.min(1)), "step {step}");
            }
        }
    }

    #[test]
    fn a_budget_smaller_than_the_skins_keeps_all_skins() {
        let sights = list(50);
        let free = plan_sights(&sights, &PlanOptions::default()).unwrap();
        // A little too small: the farthest become coarser, the nearest stay as they are.
        let budget = free.iter().map(base).sum::<f64>() - 800.0;
        let options = PlanOptions { budget, ..PlanOptions::default() };
        let tight = plan_sights(&sights, &options).unwrap();
        assert!(weight(&tight) <= budget);
        let changed: Vec<usize> = (0..50).filter(|&i| tight[i].level != free[i].level).collect();
        assert!(!changed.is_empty() && changed.iter().all(|&i| tight[i].level == 2));
        let finer = free.iter().filter(|s| s.level < 2).count();
        assert!(changed.len() < finer && changed.last() == Some(&(finer - 1)), "{changed:?} of {finer}");
        // Nothing at all: every skin at its coarsest level.
        let none = PlanOptions { budget: 0.0, ..options };
        let over = plan_sights(&sights, &none).unwrap();
        assert!(over.len() == 50 && over.iter().all(|s| (s.level, s.layers) == (2, 0)));
        assert_eq!(plan_sights(&[], &none).unwrap(), []);
    }

    #[test]
    fn odd_lists_do_no_harm_and_odd_options_are_refused() {
        let mut sights = list(4);
        sights.iter_mut().for_each(|s| (s.vertices, s.height) = (&[], f32::NAN));
        (sights[0].distance, sights[0].size) = (0.0, f32::INFINITY);
        (sights[1].distance, sights[1].size, sights[1].fraction) = (f32::NAN, f32::NAN, f32::NAN);
        sights[2].distance = f32::NEG_INFINITY;
        for budget in [0.0, 1e5, 1e9, f64::INFINITY] {
            let plan = plan_sights(&sights, &PlanOptions { budget, ..PlanOptions::default() }).unwrap();
            assert!(plan.len() == 4 && weight(&plan).is_finite());
        }
        let usual = PlanOptions::default();
        for options in [
            PlanOptions { focal: f32::NAN, ..usual },
            PlanOptions { screen: -1.0, ..usual },
            PlanOptions { budget: f64::NAN, ..usual },
            PlanOptions { pixel_weight: f64::INFINITY, ..usual },
        ] {
            assert!(matches!(plan_sights(&sights, &options), Err(Error::Range { .. })));
        }
    }
}
