//! A mouse that the test moves: a client of wlroots' protocol for virtual ones. No seat has a pointer without a mouse.

use std::cell::RefCell;
use std::os::unix::net::UnixStream;
use std::path::Path;

use wayland_client::globals::{GlobalListContents, registry_queue_init};
use wayland_client::protocol::wl_registry::{self, WlRegistry};
use wayland_client::{Connection, Dispatch, EventQueue, QueueHandle, delegate_noop};
use wayland_protocols_wlr::virtual_pointer::v1::client::zwlr_virtual_pointer_manager_v1::ZwlrVirtualPointerManagerV1;
use wayland_protocols_wlr::virtual_pointer::v1::client::zwlr_virtual_pointer_v1::ZwlrVirtualPointerV1;

/// A mouse, for as long as this lives.
pub struct Mouse {
    queue: RefCell<EventQueue<Nobody>>,
    pointer: ZwlrVirtualPointerV1,
}

/// Whom events are for.
struct Nobody;

impl Mouse {
    pub fn plug_in(socket: &Path) -> Self {
        let connection = Connection::from_socket(UnixStream::connect(socket).unwrap()).unwrap();
        let (globals, queue) = registry_queue_init::<Nobody>(&connection).unwrap();
        let handle = queue.handle();
        let manager: ZwlrVirtualPointerManagerV1 = globals.bind(&handle, 1..=1, ()).unwrap();
        let mouse =
            Self { pointer: manager.create_virtual_pointer(None, &handle, ()), queue: RefCell::new(queue) };
        mouse.does(|_| {});
        mouse
    }

    /// Does something, all at once, and returns when the compositor has taken it.
    pub fn does(&self, does: impl FnOnce(&ZwlrVirtualPointerV1)) {
        does(&self.pointer);
        self.pointer.frame();
        self.queue.borrow_mut().roundtrip(&mut Nobody).unwrap();
    }
}

impl Dispatch<WlRegistry, GlobalListContents> for Nobody {
    fn event(
        _: &mut Self,
        _: &WlRegistry,
        _: wl_registry::Event,
        _: &GlobalListContents,
        _: &Connection,
        _: &QueueHandle<Self>,
    ) {
    }
}

delegate_noop!(Nobody: ZwlrVirtualPointerManagerV1);
delegate_noop!(Nobody: ZwlrVirtualPointerV1);
