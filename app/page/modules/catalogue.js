// What the service says there is: scenes, and the figures of the thesis.

import { learn } from "./words.js";

export class Catalogue {
  // `ask(path)` returns what stands there, however long it takes.
  constructor(ask) {
    this.ask = ask;
    this.described = new Map(); // path -> scene
    this.drawn = null; // figures of the thesis
  }

  async load() {
    const scenes = await this.ask("/scenes");
    // A part from a file is dropped, not chosen.
    this.scenes = scenes.map((one) => ({ ...one, variants: one.variants.filter((name) => name !== "mesh") }));
  }

  scene(name) {
    return this.scenes.find((scene) => scene.name === name);
  }

  // All about the scene of a view, in its variant or by its method.
  async describe(view) {
    const query = new URLSearchParams(
      view.kind === "sweep"
        ? view.choice && { variant: view.choice }
        : { method: view.choice || (this.scene(view.scene)?.methods[0] ?? "events") },
    );
    const path = `/scenes/${encodeURIComponent(view.scene)}?${query}`;
    if (!this.described.has(path)) {
      const scene = await this.ask(path);
      learn(scene);
      this.described.set(path, scene);
    }
    return this.described.get(path);
  }

  async figures() {
    this.drawn ??= await this.ask("/figures");
    return this.drawn;
  }
}
