// The form's section on sweeps.

/**
 * Sets the section up. `readDocument()` gives the job document that the form describes now; `changed()` tells the form that
 * its fields were set by a script.
 */
export function initSweep(form, { readDocument, changed }) {}
