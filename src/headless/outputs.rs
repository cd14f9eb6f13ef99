//! All that a run writes: trace, picture, animation and summary.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tiny_skia::Pixmap;

use super::output::{self, Output, OutputError};
use super::{Run, RunError, Summary};
use crate::paint::{self, Animation, AnimationError, Painter};
use crate::simulation::Simulation;

/// The outputs of a run, opened before it so that a wrong path is known at once.
pub(super) struct Outputs {
    trace: Option<Output>,
    image: Option<Output>,
    gif: Option<(Animation<Output>, PathBuf)>,
    summary: Option<Output>,
    /// What frames are painted on, where any are.
    canvas: Option<Pixmap>,
    painter: Painter,
    /// Whether one of them goes to standard output.
    stdout_taken: bool,
}

impl Outputs {
    /// Opens the outputs of a run that begins with this simulation.
    pub(super) fn create(run: &Run, simulation: &Simulation) -> Result<Self, RunError> {
        // What is no file, a terminal for instance, is not written over.
        let inputs: Vec<_> =
            run.inputs.iter().filter(|path| path.is_file()).map(|path| output::canonical(path)).collect();
        let mut places = Vec::new();
        for path in [&run.trace, &run.image, &run.gif, &run.summary].into_iter().flatten() {
            let place = output::canonical(path);
            if places.contains(&place) {
                return Err(RunError::SameOutput { path: path.clone() });
            }
            if inputs.contains(&place) {
                return Err(RunError::OverInput { path: path.clone() });
            }
            places.push(place);
        }
        let stdout_taken = places.iter().any(|place| output::is_stdout(place));
        let stdout = Path::new("-");
        if run.summary.is_none() && !stdout_taken && inputs.iter().any(|input| input == stdout) {
            return Err(RunError::OverInput { path: stdout.to_owned() });
        }
        let seconds = run.course.least_seconds();
        if let Some(path) = run.gif.as_ref().filter(|_| paint::animation::is_too_long(seconds)) {
            return Err(RunError::of_animation(path, AnimationError::TooLong(seconds)));
        }
        let create = |path: &Option<PathBuf>| path.as_deref().map(Output::create).transpose();
        let (trace, image) = (create(&run.trace)?, create(&run.image)?);
        let (gif, summary) = (create(&run.gif)?, create(&run.summary)?);
        let canvas = (image.is_some() || gif.is_some()).then(|| paint::blank(simulation.world().size()));
        let canvas = canvas.transpose()?;
        let gif = match (gif, &canvas, &run.gif) {
            (Some(output), Some(canvas), Some(path)) => {
                let animation = Animation::new(output, canvas.width(), canvas.height())
                    .map_err(|source| RunError::of_animation(path, source))?;
                Some((animation, path.clone()))
            }
            _ => None,
        };
        let mut outputs =
            Self { trace, image, gif, summary, canvas, painter: Painter::default(), stdout_taken };
        outputs.write_trace(|trace| writeln!(trace, "frame,time,ball,x,y,vx,vy,colliding"))?;
        Ok(outputs)
    }

    /// Writes what a frame, from 1, adds, which ends at `time` seconds since the run's start.
    pub(super) fn add(
        &mut self,
        run: &Run,
        frame: u64,
        time: f64,
        simulation: &Simulation,
    ) -> Result<(), RunError> {
        if frame == 1 || frame.is_multiple_of(run.every.max(1)) {
            self.write_trace(|trace| {
                let states = simulation.balls().iter().zip(simulation.touching()).enumerate();
                for (index, (ball, &touching)) in states {
                    let (p, v, colliding) = (ball.position(), ball.velocity(), u8::from(touching));
                    writeln!(trace, "{frame},{time},{index},{},{},{},{},{colliding}", p.x, p.y, v.x, v.y)?;
                }
                Ok(())
            })?;
        }
        if let (Some((animation, path)), Some(canvas)) = (&mut self.gif, &mut self.canvas) {
            self.painter.repaint(simulation, 1.0, &mut canvas.as_mut());
            // Known before the run but where frames of a replay were cut short.
            let added = if paint::animation::is_too_long(time) {
                Err(AnimationError::TooLong(time))
            } else {
                animation.add(time, canvas)
            };
            added.map_err(|source| RunError::of_animation(path, source))?;
        }
        Ok(())
    }

    fn write_trace(&mut self, write: impl FnOnce(&mut Output) -> io::Result<()>) -> Result<(), OutputError> {
        let Some(trace) = &mut self.trace else { return Ok(()) };
        let Err(error) = write(trace) else { return Ok(()) };
        let error = trace.error(error);
        if error.is_broken_pipe() && (self.image.is_some() || self.gif.is_some() || self.summary.is_some()) {
            // Nobody reads on, but the files are still wanted.
            self.trace = None;
            return Ok(());
        }
        Err(error)
    }

    /// Completes every output that can be, and then tells of the first that could not.
    pub(super) fn finish(self, simulation: &Simulation, summary: &Summary) -> Result<(), RunError> {
        let Self { trace, image, gif, summary: json, mut canvas, mut painter, stdout_taken } = self;
        let traced = trace.map_or(Ok(()), Output::finish);
        let animated: Result<(), RunError> = gif.map_or(Ok(()), |(mut animation, path)| {
            let finish = || {
                // A GIF without pictures is none: of a replay without frames, it shows what the changes left.
                if let (0, Some(canvas)) = (summary.frames, &mut canvas) {
                    painter.repaint(simulation, 1.0, &mut canvas.as_mut());
                    animation.add(summary.seconds, canvas)?;
                }
                animation.finish(summary.seconds)
            };
            Ok(finish().map_err(|source| RunError::of_animation(&path, source))?.finish()?)
        });
        let painted: Result<(), RunError> = image.zip(canvas).map_or(Ok(()), |(image, mut canvas)| {
            let blank = paint::blank(simulation.world().size())?;
            if (blank.width(), blank.height()) != (canvas.width(), canvas.height()) {
                // The world has been resized.
                canvas = blank;
            }
            painter.repaint(simulation, 1.0, &mut canvas.as_mut());
            let png = canvas.encode_png().map_err(|error| image.error(io::Error::other(error)))?;
            Ok(image.complete(&png)?)
        });
        let summarised = match json {
            Some(output) => match serde_json::to_string_pretty(summary) {
                Ok(json) => output.complete(format!("{json}\n").as_bytes()),
                Err(error) => Err(output.error(error.into())),
            },
            None if stdout_taken => {
                // Standard error may be gone; the results are not there.
                let _ = writeln!(io::stderr(), "{summary}");
                Ok(())
            }
            None => {
                let text = format!("{summary}\n");
                Output::create("-".as_ref()).and_then(|stdout| stdout.complete(text.as_bytes()))
            }
        };
        traced?;
        animated?;
        painted?;
        summarised?;
        Ok(())
    }
}
