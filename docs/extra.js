// Boxes that scroll can be reached by the keyboard.
document$.subscribe(() => setTimeout(() => {
  for (const box of document.querySelectorAll(".md-typeset__scrollwrap, .formula, pre > code"))
    if (box.scrollWidth > box.clientWidth) box.tabIndex = 0
}, 100))
