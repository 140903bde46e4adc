//! `man`: pages for the manual.

use clap::CommandFactory;
use clap_mangen::Man;
use touchstone_base::files::OutputFolder;

use super::arguments::{self, Arguments};
use super::{Failure, output};

/// Prints the manual page of the program, or writes it and the pages of all commands into a folder.
pub fn man(arguments: &arguments::Man) -> Result<(), Failure> {
    let mut program = Arguments::command();
    program.build(); // gives each command its full name
    let Some(path) = &arguments.dir else {
        return output::print(&String::from_utf8_lossy(&page(&Man::new(program))?));
    };
    let folder = OutputFolder::create(path)?;
    let commands = program.get_subcommands().filter(|command| command.get_name() != "help");
    let pages: Vec<Man> =
        std::iter::once(&program).chain(commands).cloned().map(Man::new).collect();
    for man in &pages {
        folder.write(&man.get_filename(), &page(man)?)?;
    }
    output::say(&format!("{} pages in {}", pages.len(), path.display()));
    Ok(())
}

fn page(man: &Man) -> Result<Vec<u8>, Failure> {
    let mut text = Vec::new();
    man.render(&mut text).map_err(Failure::bug)?;
    Ok(text)
}
