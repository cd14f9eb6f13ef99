//! Files dropped on the window, by a source of our own: xdotool has no files to drop.

use std::error::Error;
use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

use x11rb::connection::Connection;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    Atom, AtomEnum, ClientMessageEvent, ConnectionExt as _, CreateWindowAux, EventMask, PropMode,
    SELECTION_NOTIFY_EVENT, SelectionNotifyEvent, SelectionRequestEvent, WindowClass,
};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;
use x11rb::{COPY_DEPTH_FROM_PARENT, CURRENT_TIME, NONE};

use super::display::*;

/// A file manager's side of XDND, version 5 (freedesktop.org, "Drag-and-Drop Protocol for the X Window System").
struct Source {
    connection: RustConnection,
    window: u32,
    target: u32,
    /// What is dragged, as a text/uri-list.
    list: String,
}

impl Source {
    fn new(display: &Display, target: &Window<'_>, files: &[&Path]) -> Result<Self, Box<dyn Error>> {
        let (connection, screen) = RustConnection::connect(Some(display.name()))?;
        let window = connection.generate_id()?;
        let root = connection.setup().roots[screen].root;
        let (class, aux) = (WindowClass::INPUT_OUTPUT, CreateWindowAux::new());
        connection.create_window(COPY_DEPTH_FROM_PARENT, window, root, 0, 0, 1, 1, 0, class, NONE, &aux)?;
        let lines: Vec<String> = files.iter().map(|file| format!("file://{}\r\n", file.display())).collect();
        let source = Self { connection, window, target: target.id.parse()?, list: lines.concat() };
        let selection = source.atom("XdndSelection")?;
        source.connection.set_selection_owner(window, selection, CURRENT_TIME)?;
        Ok(source)
    }

    fn atom(&self, name: &str) -> Result<Atom, Box<dyn Error>> {
        Ok(self.connection.intern_atom(false, name.as_bytes())?.reply()?.atom)
    }

    fn send(&self, message: &str, data: [u32; 4]) -> Result<(), Box<dyn Error>> {
        let kind = self.atom(message)?;
        let data = [self.window, data[0], data[1], data[2], data[3]];
        let event = ClientMessageEvent::new(32, self.target, kind, data);
        self.connection.send_event(false, self.target, EventMask::NO_EVENT, event)?;
        Ok(self.connection.flush()?)
    }

    /// Serves the list of files until the target sends this message; its data.
    fn until(&self, message: &str) -> Result<[u32; 5], Box<dyn Error>> {
        let (wanted, start) = (self.atom(message)?, Instant::now());
        while start.elapsed() < PATIENCE {
            match self.connection.poll_for_event()? {
                Some(Event::ClientMessage(event)) if event.type_ == wanted => {
                    return Ok(event.data.as_data32());
                }
                Some(Event::SelectionRequest(request)) => self.serve(&request)?,
                Some(_) => {}
                None => sleep(Duration::from_millis(5)),
            }
        }
        Err(format!("waited in vain for {message}").into())
    }

    fn serve(&self, request: &SelectionRequestEvent) -> Result<(), Box<dyn Error>> {
        let (to, property, target) = (request.requestor, request.property, request.target);
        self.connection.change_property8(PropMode::REPLACE, to, property, target, self.list.as_bytes())?;
        let notice = SelectionNotifyEvent {
            response_type: SELECTION_NOTIFY_EVENT,
            sequence: 0,
            time: request.time,
            requestor: to,
            selection: request.selection,
            target,
            property,
        };
        self.connection.send_event(false, to, EventMask::NO_EVENT, notice)?;
        Ok(self.connection.flush()?)
    }

    /// Drags what there is, said to be of this type, over the window and lets it go there; whether it was taken.
    fn drop_as(&self, kind: &str) -> Result<bool, Box<dyn Error>> {
        self.send("XdndEnter", [5 << 24, self.atom(kind)?, AtomEnum::NONE.into(), AtomEnum::NONE.into()])?;
        let (place, copy) = (300 * 65_536 + 200, self.atom("XdndActionCopy")?);
        for _ in 0..3 {
            self.send("XdndPosition", [0, place, CURRENT_TIME, copy])?;
            if self.until("XdndStatus")?[1] & 1 == 0 {
                return Ok(false);
            }
        }
        self.send("XdndDrop", [0, CURRENT_TIME, 0, 0])?;
        Ok(self.until("XdndFinished")?[1] & 1 == 1)
    }
}

fn drop_on(display: &Display, window: &Window<'_>, files: &[&Path], kind: &str) -> bool {
    Source::new(display, window, files).and_then(|source| source.drop_as(kind)).unwrap()
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn a_scene_file_that_is_dropped_is_played_and_one_that_is_wrong_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let good = file("mine.toml", "solver = \"exact\"\n[[ball]]\nposition = [100, 200]\nradius = 30\n");
    let wrong = file("wrong.toml", "gravity = \"down\"\n");
    let display = Display::start();
    let mut window = display.open(&["gravity", "--paused"]);
    assert!(drop_on(&display, &window, &[&good], "text/uri-list"));
    window.wait_title("mine · exact · 1 ball");
    window.wait("its ball", |window| window.screenshot().at(100, 200) == BALL);
    assert!(drop_on(&display, &window, &[&wrong], "text/uri-list"));
    window.wait_title("wrong.toml:1");
    window.wait_title("mine · exact · 1 ball");
    // What cannot be a file is not taken, a folder is told, and the window goes on.
    assert!(!drop_on(&display, &window, &[&good], "image/png"));
    assert!(drop_on(&display, &window, &[folder.path()], "text/uri-list"));
    window.wait_title("directory");
    window.wait_title("mine · exact · 1 ball");
    // Of many, the last.
    assert!(drop_on(&display, &window, &[&wrong, &good], "text/uri-list"));
    window.wait_title("mine · exact · 1 ball");
    assert_eq!(window.screenshot().at(100, 200), BALL);
}
