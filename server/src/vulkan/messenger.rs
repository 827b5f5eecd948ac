//! Keeps what the validation layers say. Errors and synchronization hazards are counted and fail the next
//! submission or read; performance hints are ignored.

use std::{
    ffi::{CStr, c_void},
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
};

use ash::vk;

/// Messages kept word for word; later ones are only counted.
const KEPT: usize = 32;

#[derive(Default)]
pub(crate) struct Messages {
    count: AtomicU64,
    kept: Mutex<Vec<String>>,
}

impl Messages {
    pub(crate) fn count(&self) -> u64 {
        self.count.load(Ordering::Acquire)
    }

    pub(crate) fn texts(&self) -> Vec<String> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn add(&self, text: String) {
        tracing::error!(message = %text, "validation");
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if kept.len() < KEPT {
            kept.push(text);
        }
        self.count.fetch_add(1, Ordering::Release);
    }
}

/// What to register; `messages` must outlive the instance it is used with.
pub(crate) fn create_info(messages: &Messages) -> vk::DebugUtilsMessengerCreateInfoEXT<'static> {
    vk::DebugUtilsMessengerCreateInfoEXT::default()
        .message_severity(vk::DebugUtilsMessageSeverityFlagsEXT::ERROR | vk::DebugUtilsMessageSeverityFlagsEXT::WARNING)
        .message_type(vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION)
        .pfn_user_callback(Some(on_message))
        .user_data(std::ptr::from_ref(messages).cast_mut().cast())
}

unsafe extern "system" fn on_message(
    severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _types: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    messages: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: the layer passes valid data for the length of the call, and the pointer given at
    // registration, which the instance keeps alive.
    let (data, messages) = unsafe { (&*data, &*messages.cast_const().cast::<Messages>()) };
    let id = text(data.p_message_id_name);
    let text = format!("{id}: {}", text(data.p_message));
    let hazard = id.starts_with("SYNC-");
    if hazard || severity.contains(vk::DebugUtilsMessageSeverityFlagsEXT::ERROR) {
        messages.add(text);
    } else {
        tracing::debug!(message = %text, "validation");
    }
    vk::FALSE
}

fn text(pointer: *const std::ffi::c_char) -> String {
    if pointer.is_null() {
        return String::new();
    }
    // SAFETY: the layer's strings are terminated and live for the length of the call.
    unsafe { CStr::from_ptr(pointer) }.to_string_lossy().into_owned()
}
