// Types of the module that the service makes from its table of units (src/web/quantities.rs).

/** Units with typographic symbols, by those of the API where they differ. */
export const UNIT_SYMBOLS: Record<string, string>;
