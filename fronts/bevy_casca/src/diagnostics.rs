//! Counts and times in Bevy's own diagnostics.

use bevy_app::App;
use bevy_diagnostic::{
    Diagnostic, DiagnosticMeasurement, DiagnosticPath, DiagnosticsStore, RegisterDiagnostic,
};
use bevy_ecs::prelude::*;
use bevy_platform::time::Instant;

use crate::scene::{CascaScene, Counts};

/// Names of what the plugin measures in each frame, for Bevy's
/// [`DiagnosticsStore`](bevy_diagnostic::DiagnosticsStore).
#[derive(Debug, Clone, Copy)]
pub struct CascaDiagnostics;

impl CascaDiagnostics {
    /// Entities in the scene.
    pub const ENTITIES: DiagnosticPath = DiagnosticPath::const_new("casca/entities");
    /// Of those, the ones that cameras see, summed over all cameras that have occlusion.
    pub const VISIBLE: DiagnosticPath = DiagnosticPath::const_new("casca/visible");
    /// Of those, the ones that cameras do not see: behind others or out of view. Summed as before.
    pub const CULLED: DiagnosticPath = DiagnosticPath::const_new("casca/culled");
    /// Entities in the shadow maps of all lights, each as often as it is drawn there.
    pub const CASTERS: DiagnosticPath = DiagnosticPath::const_new("casca/casters");
    /// Meshes that are prepared to hide.
    pub const OCCLUDERS: DiagnosticPath = DiagnosticPath::const_new("casca/occluders");
    /// The time of the plugin's systems, which take the place of Bevy's, in milliseconds.
    pub const TIME: DiagnosticPath = DiagnosticPath::const_new("casca/time");
}

/// All but the time.
const COUNTS: [DiagnosticPath; 5] = [
    CascaDiagnostics::ENTITIES,
    CascaDiagnostics::VISIBLE,
    CascaDiagnostics::CULLED,
    CascaDiagnostics::CASTERS,
    CascaDiagnostics::OCCLUDERS,
];

pub(crate) fn register(app: &mut App) {
    COUNTS.into_iter().for_each(|path| _ = app.register_diagnostic(Diagnostic::new(path)));
    app.register_diagnostic(Diagnostic::new(CascaDiagnostics::TIME).with_suffix("ms"));
}

/// Hands the counts of a frame on.
pub(crate) fn measure(mut casca: ResMut<CascaScene>, store: Option<ResMut<DiagnosticsStore>>) {
    let Counts { visible, culled, casters, time } = std::mem::take(&mut casca.counts);
    let Some(mut store) = store else { return };
    let entities = casca.scene.as_ref().map_or(0, casca::Scene::len);
    let counts = [entities, visible, culled, casters, casca.occluders()].map(|count| count as f64);
    let time = (CascaDiagnostics::TIME, time.as_secs_f64() * 1e3);
    for (path, value) in COUNTS.into_iter().zip(counts).chain([time]) {
        if let Some(diagnostic) = store.get_mut(&path).filter(|diagnostic| diagnostic.is_enabled) {
            diagnostic.add_measurement(DiagnosticMeasurement { time: Instant::now(), value });
        }
    }
}
