//! The pages in a real browser: Chromium driven through its own driver, against the real server with a database of its
//! own. Needs `chromium` and `chromedriver`: `scripts/prerequisites chromium` installs them.
//!
//! Every flow also fails when the browser's console shows an error, or when anything is requested from another host.
//! `HERRINGBONE_BROWSER_TEST_URL` runs the flows against a server that is already there.

mod accessibility;
mod browser;
mod compare;
mod entry;
mod form;
mod help;
mod import;
mod job;
mod keyboard;
mod links;
mod list;
mod live;
mod login;
mod offline;
mod pages;
mod pictures;
mod print;
mod process;
mod proxy;
mod report;
mod rotor;
mod server;
mod shafts;
mod speed;
mod start;
mod sweep;
mod system;
mod typed;
