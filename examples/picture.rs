//! Paints pictures of a scene: the first as a PNG and all of them as a GIF, in the folder for temporary files.
//!
//! The painter keeps what it painted last, so that pictures of which little has changed cost little.

use std::fs::{self, File};
use std::io::BufWriter;

use carom::paint::{Animation, BALL, Painter, blank};
use carom::{DVec2, Scene};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut simulation = Scene::load("elastic")?.with_size(DVec2::new(640.0, 480.0))?.build()?;
    // Two pixels for one px of the world, as on a screen of twice the density.
    let scale = 2.0;
    let mut picture = blank(simulation.world().size() * scale)?;
    let mut painter = Painter::default();

    let folder = std::env::temp_dir().join("carom-example");
    fs::create_dir_all(&folder)?;
    let gif = BufWriter::new(File::create(folder.join("elastic.gif"))?);
    let mut animation = Animation::new(gif, picture.width(), picture.height())?;
    for frame in 0..50 {
        painter.repaint(&simulation, scale, &mut picture.as_mut());
        if frame == 0 {
            picture.save_png(folder.join("elastic.png"))?;
            let middle = simulation.balls()[0].position() * scale;
            let pixel = picture.pixel(middle.x as u32, middle.y as u32).expect("the ball is in the picture");
            assert_eq!((pixel.red(), pixel.green(), pixel.blue()), (BALL.0, BALL.1, BALL.2));
        }
        animation.add(simulation.time(), &picture)?;
        simulation.advance(1.0 / 50.0)?;
    }
    animation.finish(simulation.time())?;

    for name in ["elastic.png", "elastic.gif"] {
        let path = folder.join(name);
        let length = fs::metadata(&path)?.len();
        println!("{} has {length} bytes", path.display());
        assert!(length > 1000);
    }
    Ok(())
}
