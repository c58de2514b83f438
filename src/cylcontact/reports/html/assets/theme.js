// Before the page is painted: the theme that the reader chose last.
"use strict";
try {
  const chosen = localStorage.getItem("cylcontact-theme");
  if (chosen === "light" || chosen === "dark") document.documentElement.dataset.theme = chosen;
} catch { /* a browser that keeps nothing for pages opened from disk */ }
