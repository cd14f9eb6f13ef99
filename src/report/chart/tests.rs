//! Figures as they are drawn.

use super::*;

fn figure() -> Figure {
    let curve = |solver: Solver, shift: f64| Curve {
        label: solver.name().to_owned(),
        style: Style::of(solver),
        dots: (0..8).map(|k| Dot::at(1e-6 * 2_f64.powi(k), shift * 0.5_f64.powi(k))).collect(),
        marked: 1,
        lined: true,
    };
    let panel = Panel {
        title: "A test".to_owned(),
        x: Axis::log("run time, s", [1e-6, 1e-3]),
        y: Axis::log("error, px", [1e-13, 10.0]),
        curves: vec![curve(Solver::Canvas, 10.0), curve(Solver::Exact, 1e-10)],
        guides: vec![Guide { label: "order 1".to_owned(), through: (1e-6, 10.0), slope: -1.0 }],
        note: "contact: given up".to_owned(),
    };
    Figure { name: "test".to_owned(), columns: 2, panels: vec![panel.clone(), panel] }
}

#[test]
fn the_legend_shows_lines_and_rings_where_there_are_any() {
    let mut figure = figure();
    let lined = |figure: &Figure| figure.legend().iter().map(|entry| entry.lined).collect::<Vec<_>>();
    assert_eq!(lined(&figure), [true, true]);
    figure.panels[0].curves[0].lined = false;
    figure.panels[1].curves[1].dots[2].used = true;
    assert_eq!(lined(&figure), [false, true, false]);
    assert!(matches!(figure.legend()[2].style.mark, Mark::Ring(_)));
}

#[test]
fn a_figure_is_an_svg_and_a_png_of_twice_its_size() {
    let files = figure().files().unwrap();
    assert_eq!([&*files[0].0, &*files[1].0], ["test.svg", "test.png"]);
    let svg = String::from_utf8(files[0].1.clone()).unwrap();
    assert!(svg.contains("order 1") && svg.contains("exact") && svg.contains("−12"), "{svg}");
    let png = Pixmap::decode_png(&files[1].1).unwrap();
    assert_eq!((png.width(), png.height()), (1920, 760));
    // The curves are there in their colours.
    let has = |colour: RGBColor| {
        png.pixels()
            .iter()
            .any(|pixel| (pixel.red(), pixel.green(), pixel.blue()) == (colour.0, colour.1, colour.2))
    };
    assert!(has(ORANGE) && has(BLUE) && !has(GREEN));
}

/// How many pixels of about each of these colours the diagram of a figure of one panel has, its legend left out.
fn coloured<const N: usize>(figure: &Figure, colours: [RGBColor; N]) -> [usize; N] {
    carry_font().unwrap();
    let png = Pixmap::decode_png(&figure.png().unwrap()).unwrap();
    let legend = png.width() * ENLARGED * LEGEND * figure.legend_rows() as u32;
    let diagram = &png.pixels()[..png.pixels().len() - legend as usize];
    colours.map(|RGBColor(red, green, blue)| {
        let near = |one: u8, other: u8| one.abs_diff(other) < 30;
        let is = |pixel: &&tiny_skia::PremultipliedColorU8| {
            near(pixel.red(), red) && near(pixel.green(), green) && near(pixel.blue(), blue)
        };
        diagram.iter().filter(is).count()
    })
}

#[test]
fn marks_rings_and_lines_in_one_place_all_show() {
    let colours = [ORANGE, BLUE, GREEN];
    let mut figure = figure();
    figure.columns = 1;
    figure.panels.truncate(1);
    figure.panels[0].guides.clear();
    let curve = |solver: Solver, dots: Vec<Dot>| Curve {
        label: solver.name().to_owned(),
        style: Style::of(solver),
        dots,
        marked: 1,
        lined: true,
    };
    let marks = |used: bool, solvers: &[Solver]| {
        let curve = |&solver: &Solver| curve(solver, vec![Dot { used, ..Dot::at(1e-5, 1e-4) }]);
        let panel = Panel { curves: solvers.iter().map(curve).collect(), ..figure.panels[0].clone() };
        coloured(&Figure { panels: vec![panel], ..figure.clone() }, colours)
    };
    for used in [false, true] {
        let together = marks(used, Solver::ALL);
        for (index, solver) in [Solver::Canvas, Solver::Exact, Solver::Contact].into_iter().enumerate() {
            let (seen, whole) = (together[index], marks(used, &[solver])[index]);
            assert!(5 * seen > whole && seen > 40, "{solver}: {seen} of {whole}");
        }
    }
    for reversed in [false, true] {
        let line = vec![Dot::at(1e-6, 1e-4), Dot::at(1e-3, 1e-9)];
        let mut curves = [Solver::Exact, Solver::Contact].map(|solver| Curve {
            style: Style { mark: Mark::None, ..Style::of(solver) },
            ..curve(solver, line.clone())
        });
        if reversed {
            curves.reverse();
        }
        figure.panels[0].curves = curves.to_vec();
        let [_, whole, dashed] = coloured(&figure, colours);
        assert!(whole > 1000 && dashed > 1000, "{whole} and {dashed}");
    }
}

#[test]
fn the_line_of_a_curve_goes_through_the_dots_that_it_joins() {
    let mut figure = figure();
    figure.columns = 1;
    figure.panels.truncate(1);
    figure.panels[0].guides.clear();
    figure.panels[0].curves = vec![Curve {
        style: Style::of(Solver::Exact),
        dots: vec![Dot::at(1e-5, 1e-4), Dot::at(1e-4, 1e-4), Dot { joined: false, ..Dot::at(1e-4, 1e-8) }],
        ..figure.panels[0].curves[1].clone()
    }];
    carry_font().unwrap();
    let svg = figure.svg().unwrap();
    let lines: Vec<&str> =
        svg.split("<polyline").filter(|tag| tag.split('>').next().unwrap().contains("#005AA0")).collect();
    let points = |line: &str| {
        line.split("points=\"").nth(1).unwrap().split('"').next().unwrap().trim().split(' ').count()
    };
    // That of the legend, too.
    assert!(!lines.is_empty() && lines.iter().all(|line| points(line) == 2), "{lines:?}");
    assert_eq!(svg.matches("<circle").count(), 4, "{svg}");
}

/// The texts of an SVG: where they begin or end, and what they say.
fn texts(svg: &str) -> Vec<((f64, f64), String)> {
    let number = |tag: &str, name: &str| {
        tag.split(&format!(" {name}=\"")).nth(1).unwrap().split('"').next().unwrap().parse().unwrap()
    };
    let texts = svg.split("<text").skip(1).map(|text| {
        let (tag, rest) = text.split_once('>').unwrap();
        ((number(tag, "x"), number(tag, "y")), rest.split('<').next().unwrap().trim().to_owned())
    });
    texts.collect()
}

#[test]
fn an_exponent_is_right_behind_its_ten_and_above_it() {
    carry_font().unwrap();
    let texts = texts(&figure().svg().unwrap());
    let behind = |text: &str| {
        let pairs = texts.windows(2).filter(|pair| pair[0].1 == "10" && pair[1].1 == text);
        pairs.map(|pair| (pair[1].0.0 - pair[0].0.0, pair[1].0.1 - pair[0].0.1)).collect::<Vec<_>>()
    };
    for exponent in ["−12", "−6", "0"] {
        let places = behind(exponent);
        assert!(!places.is_empty(), "{exponent}");
        assert!(
            places.iter().all(|&(x, y)| (12.0..18.0).contains(&x) && (-8.0..-3.0).contains(&y)),
            "{places:?}"
        );
    }
}

#[test]
fn a_level_guide_goes_from_edge_to_edge() {
    carry_font().unwrap();
    let mut figure = figure();
    figure.columns = 1;
    figure.panels.truncate(1);
    figure.panels[0].curves.clear();
    figure.panels[0].guides = vec![Guide { label: "chance".to_owned(), through: (1e-5, 1e-4), slope: 0.0 }];
    let svg = figure.svg().unwrap();
    let lines: Vec<&str> = svg.split("<polyline").filter(|tag| tag.contains("#AFAFAF")).collect();
    assert_eq!(lines.len(), 1, "{svg}");
    let points = lines[0].split("points=\"").nth(1).unwrap().split('"').next().unwrap();
    let places: Vec<f64> = points.split([' ', ',']).filter_map(|place| place.parse().ok()).collect();
    let &[left, one, right, other] = places.as_slice() else { panic!("{points}") };
    assert!(one == other && right - left > 0.85 * f64::from(WIDE), "{points}");
}

#[test]
fn no_line_crosses_a_guides_name_where_there_is_a_place_for_it() {
    carry_font().unwrap();
    // A curve that falls steeply, a mark whose spread goes from end to end, and a curve that goes along most of the guide.
    let steep = (0..30).map(|step| 10_f64.powf(-6.0 + f64::from(step) / 10.0));
    let steep = steep.map(|x| vec![Dot::at(x, 10.0), Dot::at(1.02 * x, 1e-13)]);
    let level = (0..28).map(|step| 10_f64.powf(1.0 - f64::from(step) / 2.0));
    let level = level.map(|y| vec![Dot { spread: Some((1e-6, 1e-3)), ..Dot::at(1e-6, y) }]);
    let along = vec![Dot::at(2e-6, 6.5), Dot::at(2.9e-4, 1.3e-5 / 2.9e-4)];
    for dots in steep.chain(level).chain([along]) {
        let mut figure = figure();
        figure.columns = 1;
        figure.panels.truncate(1);
        let panel = &mut figure.panels[0];
        panel.curves.truncate(1);
        panel.curves[0].style = Style::of(Solver::Exact);
        panel.curves[0].dots.clone_from(&dots);
        let svg = figure.svg().unwrap();
        let ((left, below), _) = texts(&svg).into_iter().find(|(_, text)| text == "order 1").unwrap();
        let lines = svg.split("<polyline").filter(|tag| tag.contains("#005AA0"));
        // A name of seven letters, 14 px high.
        let crossed = lines.filter(|line| {
            let points = line.split("points=\"").nth(1).unwrap().split('"').next().unwrap();
            let points: Vec<f64> = points.split([' ', ',']).filter_map(|it| it.parse().ok()).collect();
            (0..=1000).map(|step| f64::from(step) / 1000.0).any(|share| {
                let at =
                    |index: usize| points[index] + share * (points[points.len() - 2 + index] - points[index]);
                (0.0..42.0).contains(&(at(0) - left)) && (0.0..11.0).contains(&(below - at(1)))
            })
        });
        assert_eq!(crossed.count(), 0, "the name at {left}, {below} and the line of {dots:?}");
    }
}
