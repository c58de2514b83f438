// Apply the reader's last choice of theme before the page is painted.
"use strict";
try {
  const chosen = localStorage.getItem("cylcontact-theme");
  if (chosen === "light" || chosen === "dark") document.documentElement.dataset.theme = chosen;
} catch { /* no storage for pages opened from disk */ }
