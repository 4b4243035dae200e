"""The workbench: a target, its options, and the sheet that comes of them, looked at while it is made.

What a user chose, what is known and what is drawn are three frozen values, made by pure functions and tested without
a window; a window or a page holds one of each and moves them on:

======================  ================================================================================
`state.State`           what the user chose: options of the fit, stages shown, field, pick, deployment;
                        `with_option`, `toggled`, `colored`, `picked`, `deployed_to` give the next one
`history.History`       undo and redo of states: `did`, `adjusted`, `undone`, `redone`
`options.options()`     every option as a panel shows it; `changed(spec, name, value)`, `turned`, `resized`
`pipeline.Stage`        target, pattern, guess, fit, contracted, holes; `first_stale(before, after)`
`engine.Engine`         fits in a process of its own: `start(spec, since, until, resume)`, `cancel()`,
                        `save(folder)`, `draw(Draw(scenes, path))`, `events()`
`events`                what goes between the processes: requests, and reports such as `Moved`, `Fitted`
`results.Results`       what is known: `begun(job)`, `received(event)` give the next one
`poses.Poses`           where the sheet lies in both views, for every share of its deployment
`scene`                 `deployed_view` and `contracted_view` of (state, results, poses): `viewers.scenes.Scene`
`details`               numbers of what is picked, rows of the certificate, in words
`opening`               the first state and results of a target or a run: `open_any(name, **options)`
`session.Session`       holds all of these and moves them on: `do`, `undo`, `fit`, `preview`, `listen`, `scenes`
`progress`              how far a fit is, as a share and in words
`views.Views`           both views in one pyvista plotter: `show(scenes)`, `hit`, `link`, `reset`
`placing.Placing`       a pattern that a hand turns and sizes: `drag`, `follow`
======================  ================================================================================

What a window does, on a timer::

    session = Session(*open_any("hypar", cells=(8, 8)), engine)
    session.fit()
    if session.listen():
        contracted, deployed = session.scenes()

Nothing of it knows Qt or the browser; `desktop` is the window, `web` the page.
"""
