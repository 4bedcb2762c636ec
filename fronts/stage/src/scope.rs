//! What the device refuses.

use std::sync::{Arc, Mutex, PoisonError};

use wgpu::{Device, ErrorFilter};

/// What a device told after the work that it was about: the first of it.
#[derive(Clone, Default)]
pub(crate) struct Trouble(Arc<Mutex<Option<String>>>);

impl Trouble {
    /// What `device` will tell. Outside of pages nothing comes late: an error that nobody listens
    /// to ends the program there, as a mistake in it.
    pub(crate) fn of(device: &Device) -> Self {
        let trouble = Self::default();
        if cfg!(target_arch = "wasm32") {
            let (lost, uncaught) = (trouble.clone(), trouble.clone());
            device.set_device_lost_callback(move |reason, why| {
                // It is also lost where the program drops it.
                if reason != wgpu::DeviceLostReason::Destroyed {
                    lost.tell(format!("the graphics device is lost: {why}"));
                }
            });
            device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| uncaught.tell(error.to_string())));
        }
        trouble
    }

    fn tell(&self, why: String) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(why);
    }

    pub(crate) fn take(&self) -> Option<String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// Does work, and returns the first error of these kinds that the device answers with. In a page
/// WebGPU answers later: then it is in the trouble.
pub(crate) fn refused<T>(
    (device, trouble): (&Device, &Trouble),
    kinds: &[ErrorFilter],
    work: impl FnOnce() -> T,
) -> (T, Option<wgpu::Error>) {
    let Some((kind, others)) = kinds.split_first() else { return (work(), None) };
    let scope = device.push_error_scope(*kind);
    // The inner scope ends first.
    let (done, inner) = refused((device, trouble), others, work);
    (done, inner.or(answer(trouble, scope.pop())))
}

#[cfg(not(target_arch = "wasm32"))]
fn answer(_: &Trouble, scope: impl Future<Output = Option<wgpu::Error>>) -> Option<wgpu::Error> {
    pollster::block_on(scope)
}

#[cfg(target_arch = "wasm32")]
fn answer(
    trouble: &Trouble,
    scope: impl Future<Output = Option<wgpu::Error>> + 'static,
) -> Option<wgpu::Error> {
    use std::task::{Context, Poll, Waker};

    let mut scope = Box::pin(scope);
    if let Poll::Ready(error) = scope.as_mut().poll(&mut Context::from_waker(Waker::noop())) {
        return error;
    }
    let trouble = trouble.clone();
    wasm_bindgen_futures::spawn_local(async move {
        if let Some(error) = scope.await {
            trouble.tell(error.to_string());
        }
    });
    None
}
