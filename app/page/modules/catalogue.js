// What the service says there is: scenes, and the figures of the thesis.

export class Catalogue {
  // `ask(path)` returns what stands there, however long it takes.
  constructor(ask) {
    this.ask = ask;
    this.replies = new Map(); // by path
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
  describe(view) {
    const query = new URLSearchParams(
      view.kind === "sweep"
        ? view.choice && { variant: view.choice }
        : { method: view.choice || (this.scene(view.scene)?.methods[0] ?? "events") },
    );
    return this.kept(`/scenes/${encodeURIComponent(view.scene)}?${query}`);
  }

  figures() {
    return this.kept("/figures");
  }

  async kept(path) {
    if (!this.replies.has(path)) this.replies.set(path, await this.ask(path));
    return this.replies.get(path);
  }
}
