//! The walk in a terminal.

use std::error::Error;
use std::time::Duration;

use ratatui::crossterm::event::{self, Event, KeyCode, KeyEventKind};
use ratatui::style::{Color, Style};
use ratatui::{DefaultTerminal, Frame};

use crate::game::Game;
use crate::look::{self, look};

/// Time for a key, before the guards go on.
const TURN: Duration = Duration::from_millis(160);
/// Columns of a tile: letters are about twice as high as wide.
const COLUMNS: u16 = 2;

/// Plays until the user ends it.
pub fn play(game: &mut Game) -> Result<(), Box<dyn Error>> {
    let mut terminal = ratatui::try_init()?;
    let result = turns(game, &mut terminal);
    ratatui::try_restore()?;
    result
}

fn turns(game: &mut Game, terminal: &mut DefaultTerminal) -> Result<(), Box<dyn Error>> {
    let mut explores = false;
    loop {
        terminal.draw(|frame| draw(game, frame))?;
        let mut step = None;
        if event::poll(TURN)?
            && let Event::Key(key) = event::read()?
            && key.kind != KeyEventKind::Release
        {
            match key.code {
                KeyCode::Char('q') | KeyCode::Esc => return Ok(()),
                KeyCode::Char('x') => explores = !explores,
                KeyCode::Char(' ') => game.turn_doors(),
                KeyCode::Right | KeyCode::Char('d') => step = Some((1, 0)),
                KeyCode::Left | KeyCode::Char('a') => step = Some((-1, 0)),
                KeyCode::Down | KeyCode::Char('s') => step = Some((0, 1)),
                KeyCode::Up | KeyCode::Char('w') => step = Some((0, -1)),
                _ => {}
            }
        }
        if explores && step.is_none() {
            step = game.next_step();
        }
        if let Some(step) = step {
            game.step(step);
        }
        game.end_turn()?;
    }
}

/// Draws the part of the map about the walker, and a line of text below.
fn draw(game: &Game, frame: &mut Frame) {
    let area = frame.area();
    let shown = (u32::from(area.width / COLUMNS), u32::from(area.height.saturating_sub(1)));
    let size = game.size();
    let first =
        |walker: u32, shown: u32, size: u32| walker.saturating_sub(shown / 2).min(size.saturating_sub(shown));
    let corner = (first(game.walker.0, shown.0, size.0), first(game.walker.1, shown.1, size.1));
    let color = |[red, green, blue]: look::Color| Color::Rgb(red, green, blue);
    let buffer = frame.buffer_mut();
    for y in 0..shown.1.min(size.1) {
        for x in 0..shown.0.min(size.0) {
            let look = look(game, (corner.0 + x, corner.1 + y));
            let text: String = std::iter::repeat_n(look.letter, COLUMNS.into()).collect();
            let style = Style::new().fg(color(look.ink)).bg(color(look.ground));
            buffer.set_string(x as u16 * COLUMNS, y as u16, text, style);
        }
    }
    let guards = game.guards.iter().filter(|guard| game.fog.seen().get(guard.at.0, guard.at.1)).count();
    let alert = if game.guards.iter().any(|guard| guard.alert) { "A guard sees you! " } else { "" };
    let help = "arrows: walk, space: doors, x: explore, q: end";
    let text = format!("{alert}{guards} of {} guards in sight. {help}", game.guards.len());
    buffer.set_stringn(0, area.height.saturating_sub(1), text, area.width.into(), Style::new());
}
