// Files that the browser saves.

import { element } from "./elements.js";

const KEPT = 10_000; // ms for which a file that is being saved stays in memory

export function save(blob, name) {
  const link = element("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), KEPT);
}
