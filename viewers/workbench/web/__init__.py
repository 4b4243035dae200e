"""The workbench in a browser: a page on loopback that shows what the desktop window shows, from the same session.

=============  ==================================================================================================
`serving`      the server: trame (Kitware's, Apache-2) keeps a page's values in step with those of this process;
               it brings Vue, and nothing is loaded from elsewhere
`guard`        who is let in: a random key in every address, allow-lists of hosts and origins
`routes`       what answers at which address
`values`       what the page shows, from a session, as plain values: tested without a browser
`editors`      the options of a fit as the page edits them
`charts`       color bar, scale bars and residual curves as shapes with places
`desk`         one session for all browsers: what they ask of it, and what the engine reports
`browser`      the socket of one browser: what its hand does comes in, images go out
`pictures`     the two views of one browser, drawn off-screen by VTK
`camera`       a camera that a hand turns, shifts and brings nearer
`exchange`     files between browsers and the engine: `uploads` through the guarded readers, `downloads`
`awaited`      files that somebody waits for
`opener`       opens the page in the user's browser
=============  ==================================================================================================

Pictures are drawn here and not in the browser: no browser needs WebGL, and the tiles of a large sheet stay where they
are. Every browser has cameras of its own, which trame's remote view has not (one window, one size for all), and a
socket of its own for images as fast as it can show them.
"""
