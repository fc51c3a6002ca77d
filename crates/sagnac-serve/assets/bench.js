// Keeps a page up to date. Without it the pages work all the same: they are sent anew.
"use strict";

// The token stands behind `#`, where only this script sees it. It becomes a cookie that no script reads.
const signIn = document.querySelector("[data-sign-in]");
const token = new URLSearchParams(location.hash.slice(1)).get("token");
if (token) {
  history.replaceState(null, "", location.pathname + location.search);
  if (signIn) {
    fetch("/session", {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify({ token }),
    }).then((answer) => {
      if (answer.ok) location.replace(location.pathname + location.search);
      else signIn.querySelector("input").focus();
    });
  }
}

// A scanner types like a keyboard: what is typed outside of a field belongs to the serial number.
const field = document.querySelector("[data-focus]");
if (field) {
  document.addEventListener("keydown", (event) => {
    const typed = event.key.length === 1 && !event.ctrlKey && !event.altKey && !event.metaKey && event.key !== " ";
    if (typed && !event.target.closest("input, select, textarea")) {
      field.focus();
    }
  });
}

// Lines of progress, and the page anew at the end: what was typed meanwhile is kept.
const kept = "sagnac-typed";
if (field && sessionStorage.getItem(kept)) {
  field.value = sessionStorage.getItem(kept);
  sessionStorage.removeItem(kept);
}
for (const place of document.querySelectorAll("[data-events]")) {
  const events = new EventSource(place.dataset.events);
  const line = place.querySelector("[data-progress]");
  events.addEventListener("progress", (event) => {
    if (line) line.textContent = JSON.parse(event.data).text;
  });
  events.addEventListener("ended", () => {
    events.close();
    if (field && field.value) sessionStorage.setItem(kept, field.value);
    location.reload();
  });
}
