//! The window on a display of its own, as a user would use it: pointer, keys, and the pixels on the screen.

use super::place::{BOX, Place, failed};
use manylight::output::read_png;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{
    self, AtomEnum, ClientMessageEvent, ConfigureWindowAux, ConnectionExt as _, EventMask, ImageFormat, InputFocus,
};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;

/// Longest wait for something to appear.
const PATIENCE: Duration = Duration::from_secs(60);

/// An X server without a screen. It ends with its test.
struct Display {
    server: Child,
    name: String,
}

impl Display {
    /// `None`, loudly, where there is no Xvfb.
    fn open() -> Option<Self> {
        let server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1600x1000x24", "-nolisten", "tcp"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let Ok(mut server) = server else {
            assert!(std::env::var_os("CI").is_none(), "CI has no Xvfb");
            eprintln!("SKIPPED: there is no Xvfb; on Debian or Ubuntu, `apt install xvfb` brings it");
            return None;
        };
        let mut line = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut line).unwrap();
        Some(Self { server, name: format!(":{}", line.trim()) })
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// A user in front of the window.
struct User<'d> {
    program: Child,
    connection: RustConnection,
    root: xproto::Window,
    window: xproto::Window,
    _display: &'d Display,
}

/// Pixels of the window, RGB.
struct Screen {
    width: usize,
    height: usize,
    pixels: Vec<[u8; 3]>,
}

impl<'d> User<'d> {
    /// Opens the window on a config, and waits until it shows a frame.
    fn open(display: &'d Display, place: &Place, arguments: &[&str]) -> Self {
        let program = place
            .manylight()
            .arg("view")
            .args(arguments)
            .args(["--device", "cpu", "--validate"])
            .env("DISPLAY", &display.name)
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET")
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let (connection, screen) = x11rb::connect(Some(&display.name)).unwrap();
        let root = connection.setup().roots[screen].root;
        let mut user = Self { program, connection, root, window: 0, _display: display };
        user.window = user.wait("a window", |user| {
            let windows = user.connection.query_tree(user.root).unwrap().reply().unwrap().children;
            windows.into_iter().find(|window| {
                let name = user.connection.get_property(false, *window, AtomEnum::WM_NAME, AtomEnum::ANY, 0, 64).unwrap().reply();
                let attributes = user.connection.get_window_attributes(*window).unwrap().reply();
                let is_seen = attributes.is_ok_and(|of| of.map_state == xproto::MapState::VIEWABLE);
                is_seen && name.is_ok_and(|name| name.value.ends_with(b" - manylight"))
            })
        });
        user.connection.set_input_focus(InputFocus::PARENT, user.window, x11rb::CURRENT_TIME).unwrap();
        user.connection.flush().unwrap();
        user
    }

    fn wait<T>(&mut self, what: &str, mut found: impl FnMut(&mut Self) -> Option<T>) -> T {
        let begun = Instant::now();
        while begun.elapsed() < PATIENCE {
            if let Some(found) = found(self) {
                return found;
            }
            if let Some(status) = self.program.try_wait().unwrap() {
                panic!("the program ended with {status} before {what} came: {}", self.said());
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        panic!("{what} did not come in {PATIENCE:?}");
    }

    fn said(&mut self) -> String {
        let mut said = String::new();
        self.program.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        said
    }

    fn input(&self, kind: u8, detail: u8, x: i16, y: i16) {
        self.connection.xtest_fake_input(kind, detail, 0, self.root, x, y, 0).unwrap();
        self.connection.flush().unwrap();
        std::thread::sleep(Duration::from_millis(30));
    }

    fn point(&self, x: i16, y: i16) {
        self.input(xproto::MOTION_NOTIFY_EVENT, 0, x, y);
    }

    fn button(&self, button: u8, down: bool) {
        self.input(if down { xproto::BUTTON_PRESS_EVENT } else { xproto::BUTTON_RELEASE_EVENT }, button, 0, 0);
    }

    fn click(&self, x: i16, y: i16) {
        self.point(x, y);
        self.button(1, true);
        self.button(1, false);
    }

    /// Presses or releases a key by its symbol.
    fn key(&self, symbol: u32, down: bool) {
        let setup = self.connection.setup();
        let (first, count) = (setup.min_keycode, setup.max_keycode - setup.min_keycode + 1);
        let map = self.connection.get_keyboard_mapping(first, count).unwrap().reply().unwrap();
        let each = usize::from(map.keysyms_per_keycode);
        let index = map.keysyms.chunks(each).position(|symbols| symbols[0] == symbol).unwrap();
        let kind = if down { xproto::KEY_PRESS_EVENT } else { xproto::KEY_RELEASE_EVENT };
        self.input(kind, first + index as u8, 0, 0);
    }

    fn press(&self, symbol: char) {
        self.key(symbol.into(), true);
        self.key(symbol.into(), false);
    }

    fn press_control(&self, symbol: char) {
        const CONTROL: u32 = 0xffe3;
        self.key(CONTROL, true);
        self.press(symbol);
        self.key(CONTROL, false);
    }

    /// What the window shows; `None` once it is gone.
    fn screen(&self) -> Option<Screen> {
        let size = self.connection.get_geometry(self.window).unwrap().reply().ok()?;
        let (width, height) = (size.width, size.height);
        let image = self.connection.get_image(ImageFormat::Z_PIXMAP, self.window, 0, 0, width, height, !0).unwrap().reply().ok()?;
        let pixels = image.data.chunks_exact(4).map(|pixel| [pixel[2], pixel[1], pixel[0]]).collect();
        Some(Screen { width: width.into(), height: height.into(), pixels })
    }

    fn resize(&self, width: u32, height: u32) {
        self.connection.configure_window(self.window, &ConfigureWindowAux::new().width(width).height(height)).unwrap();
        self.connection.flush().unwrap();
    }

    /// Waits until the window shows a picture, pixel by pixel.
    #[track_caller]
    fn sees(&mut self, picture: &[[u8; 3]], width: usize) {
        self.wait("the picture in the window", |user| user.screen()?.find(picture, width));
    }

    /// The text in the clipboard, as another program would get it.
    fn clipboard(&mut self) -> String {
        let atom = |user: &Self, name: &str| user.connection.intern_atom(false, name.as_bytes()).unwrap().reply().unwrap().atom;
        let [clipboard, text, mine] = ["CLIPBOARD", "UTF8_STRING", "MANYLIGHT_TEST"].map(|name| atom(self, name));
        let window = self.connection.generate_id().unwrap();
        self.connection
            .create_window(0, window, self.root, 0, 0, 1, 1, 0, xproto::WindowClass::INPUT_ONLY, 0, &Default::default())
            .unwrap();
        self.wait("text in the clipboard", |user| {
            user.connection.convert_selection(window, clipboard, text, mine, x11rb::CURRENT_TIME).unwrap();
            user.connection.flush().unwrap();
            std::thread::sleep(Duration::from_millis(100));
            let got = user.connection.get_property(true, window, mine, AtomEnum::ANY, 0, 1 << 16).unwrap().reply().unwrap();
            (!got.value.is_empty()).then(|| String::from_utf8(got.value).unwrap())
        })
    }

    /// Waits for a file that is newer than the one that was there.
    fn file(&mut self, path: &Path) {
        self.wait("a file", |_| path.is_file().then_some(()));
    }

    /// Closes the window as its button would, and checks that the program ended well.
    #[track_caller]
    fn close(mut self) {
        let atom = |name: &str| self.connection.intern_atom(false, name.as_bytes()).unwrap().reply().unwrap().atom;
        let message = ClientMessageEvent::new(32, self.window, atom("WM_PROTOCOLS"), [atom("WM_DELETE_WINDOW"), 0, 0, 0, 0]);
        self.connection.send_event(false, self.window, EventMask::NO_EVENT, message).unwrap();
        self.connection.flush().unwrap();
        let begun = Instant::now();
        while begun.elapsed() < PATIENCE {
            if let Some(status) = self.program.try_wait().unwrap() {
                assert!(status.success(), "{status}: {}", self.said());
                return;
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        panic!("the window did not close in {PATIENCE:?}");
    }
}

impl Drop for User<'_> {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

impl Screen {
    /// Place of a picture on the screen.
    fn find(&self, picture: &[[u8; 3]], width: usize) -> Option<[usize; 2]> {
        let height = picture.len() / width;
        let is_at = |x: usize, y: usize| {
            (0..height).all(|row| self.pixels[(y + row) * self.width + x..][..width] == picture[row * width..][..width])
        };
        let places = (0..self.height.saturating_sub(height)).flat_map(|y| (0..self.width.saturating_sub(width)).map(move |x| [x, y]));
        places.into_iter().find(|[x, y]| is_at(*x, *y))
    }
}

/// A PNG's pixels, RGB, and its width.
fn picture(path: &Path) -> (Vec<[u8; 3]>, usize) {
    let png = read_png(path).unwrap();
    let byte = |value: f32| (value * 255.0).round() as u8;
    (png.values.chunks_exact(3).map(|pixel| [byte(pixel[0]), byte(pixel[1]), byte(pixel[2])]).collect(), png.width as usize)
}

/// The window on the box, and the picture that `render` writes of it, which it shows pixel by pixel.
fn opened<'d>(display: &'d Display, place: &Place) -> (User<'d>, Vec<[u8; 3]>, usize) {
    place.succeeds("render box.toml --frames 1 -o still --quiet");
    let (still, width) = picture(&place.path("still/image.png"));
    let mut user = User::open(display, place, &["box.toml"]);
    user.click(740, 430);
    user.press('1');
    user.sees(&still, width);
    (user, still, width)
}

#[test]
fn the_window_shows_the_pixels_that_render_writes() {
    let Some(display) = Display::open() else { return };
    let place = Place::new(&[("box.toml", BOX)]);
    let (user, ..) = opened(&display, &place);
    user.close();
}

#[test]
fn a_flight_is_saved_as_a_config_and_copied_as_a_command_whose_pictures_are_the_windows() {
    let Some(display) = Display::open() else { return };
    let place = Place::new(&[("box.toml", BOX)]);
    let (mut user, ..) = opened(&display, &place);
    user.press_control('s');
    user.file(&place.path("out/box-view/image.exr"));
    let (before, _) = picture(&place.path("out/box-view/image.png"));
    std::fs::remove_dir_all(place.path("out")).unwrap();
    // To the left, and ahead.
    user.button(1, true);
    (1..=8).for_each(|step| user.point(740 - 6 * step, 430));
    user.button(1, false);
    user.key('w'.into(), true);
    std::thread::sleep(Duration::from_millis(400));
    user.key('w'.into(), false);
    std::thread::sleep(Duration::from_millis(500));
    user.press_control('s');
    user.file(&place.path("out/box-view/image.exr"));
    let (after, width) = picture(&place.path("out/box-view/image.png"));
    assert_ne!(before, after, "the camera has moved");
    user.sees(&after, width);
    user.press_control('k');
    let line = user.clipboard();
    user.close();
    place.succeeds("render out/box-view/box.toml --frames 1 -o again --quiet");
    // The line is for a shell, which finds the program by its name.
    let line = format!("{line} --device cpu --quiet -o copied");
    let program = Path::new(env!("CARGO_BIN_EXE_manylight")).parent().unwrap();
    let status = Command::new("/bin/sh").args(["-c", &line]).current_dir(place.root()).env("PATH", program).status().unwrap();
    assert!(status.success(), "{line}: {status}");
    for file in ["image.png", "image.exr"] {
        let saved = place.read(&format!("out/box-view/{file}"));
        assert!(saved == place.read(&format!("again/{file}")), "{file} of the saved config differs");
        assert!(saved == place.read(&format!("copied/{file}")), "{file} of {line} differs");
    }
}

#[test]
fn a_window_of_any_size_shows_the_picture_once_it_is_large_enough() {
    let Some(display) = Display::open() else { return };
    let place = Place::new(&[("box.toml", BOX)]);
    let (mut user, still, width) = opened(&display, &place);
    let times: u32 = std::env::var("MANYLIGHT_RESIZES").ok().and_then(|times| times.parse().ok()).unwrap_or(60);
    let mut random = 12_345u32;
    let mut next = |below: u32| {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        1 + (random >> 8) % below
    };
    for _ in 0..times {
        user.resize(next(1600), next(1000));
        std::thread::sleep(Duration::from_millis(u64::from(next(40))));
    }
    user.resize(1300, 800);
    user.sees(&still, width);
    user.close();
}

#[test]
fn without_a_display_the_program_ends_with_3_and_a_sentence() {
    let place = Place::new(&[("box.toml", BOX)]);
    let mut command = place.command("view box.toml");
    ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"].iter().for_each(|name| {
        command.env_remove(name);
    });
    failed("view", &command.output().unwrap(), 3, &["no window can be opened", "manylight render"]);
}
