//! The Vulkan instance, with validation layers where asked for.
//!
//! Every device has an instance of its own: software drivers run all devices of one instance through one
//! queue, so a long job on one would block the others.

use std::{ffi::CStr, sync::Arc};

use ash::{Entry, ext::debug_utils, vk};

use super::{
    error::{Error, Result, failed},
    messenger::{self, Messages},
};

const VALIDATION_LAYER: &CStr = c"VK_LAYER_KHRONOS_validation";
const INSTALL_DRIVER: &str = "install libvulkan1 and mesa-vulkan-drivers 25 or later, or the driver of your GPU";

pub(crate) struct Instance {
    pub(crate) handle: ash::Instance,
    pub(crate) messages: Option<Box<Messages>>,
    debug: Option<(debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
    /// Keeps the loader's library open.
    _entry: Entry,
}

impl Instance {
    pub(crate) fn new(validation: bool) -> Result<Arc<Self>> {
        // SAFETY: the loader is a well-known library whose initialisers do nothing unusual.
        let entry = unsafe { Entry::load() }.map_err(|cause| {
            Error::unsupported(format!("there is no Vulkan loader on this machine: {INSTALL_DRIVER}")).with_cause(cause)
        })?;
        let messages = validation.then(Box::<Messages>::default);
        if validation {
            require_validation_layer(&entry)?;
        }
        let handle = create(&entry, messages.as_deref())?;
        let mut instance = Self { handle, messages, debug: None, _entry: entry };
        instance.debug = instance.listen()?;
        Ok(Arc::new(instance))
    }

    pub(crate) fn validates(&self) -> bool {
        self.messages.is_some()
    }

    fn listen(&self) -> Result<Option<(debug_utils::Instance, vk::DebugUtilsMessengerEXT)>> {
        let Some(messages) = &self.messages else { return Ok(None) };
        let debug = debug_utils::Instance::new(&self._entry, &self.handle);
        // SAFETY: the messages are boxed and outlive the messenger, which `drop` destroys first.
        let messenger = unsafe { debug.create_debug_utils_messenger(&messenger::create_info(messages), None) }
            .map_err(failed("creating the debug messenger"))?;
        Ok(Some((debug, messenger)))
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        // SAFETY: every device keeps this instance alive, so none is left, and the messenger goes first.
        unsafe {
            if let Some((debug, messenger)) = self.debug.take() {
                debug.destroy_debug_utils_messenger(messenger, None);
            }
            self.handle.destroy_instance(None);
        }
    }
}

fn require_validation_layer(entry: &Entry) -> Result<()> {
    // SAFETY: no preconditions beyond a loaded entry.
    let layers = unsafe { entry.enumerate_instance_layer_properties() }.map_err(failed("listing layers"))?;
    if layers.iter().any(|layer| layer.layer_name_as_c_str() == Ok(VALIDATION_LAYER)) {
        return Ok(());
    }
    Err(Error::unsupported("validation was asked for, but the layer is missing: install vulkan-validationlayers"))
}

fn create(entry: &Entry, messages: Option<&Messages>) -> Result<ash::Instance> {
    let application = vk::ApplicationInfo::default().application_name(c"displace").api_version(vk::API_VERSION_1_3);
    let layers = [VALIDATION_LAYER.as_ptr()];
    let extensions = [debug_utils::NAME.as_ptr()];
    let enabled = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
    let mut features = vk::ValidationFeaturesEXT::default().enabled_validation_features(&enabled);
    let mut info = vk::InstanceCreateInfo::default().application_info(&application);
    let mut messenger;
    if let Some(messages) = messages {
        messenger = messenger::create_info(messages);
        info = info
            .enabled_layer_names(&layers)
            .enabled_extension_names(&extensions)
            .push_next(&mut features)
            .push_next(&mut messenger);
    }
    // SAFETY: `info` and what it points to live to the end of the call; the caller destroys the instance.
    unsafe { entry.create_instance(&info, None) }.map_err(|result| match result {
        vk::Result::ERROR_INCOMPATIBLE_DRIVER => {
            Error::unsupported(format!("there is no Vulkan driver on this machine: {INSTALL_DRIVER}"))
        }
        other => failed("creating the Vulkan instance")(other),
    })
}
