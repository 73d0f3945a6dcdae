// The controls beside the picture, and the choice of what is plotted.

const DISPLAYED_SCALES = 20;        // steps of the slider for each factor of ten
const SMALL = "(max-width: 720px), (max-height: 560px)";     // screens on which the panel is closed

const element = (name) => document.getElementById(name);

function fill(select, options, chosen) {
  select.replaceChildren(...options.map(([value, text]) => new Option(text, value)));
  select.value = String(chosen);
}

class Controls {
  constructor(page) {
    this.page = page;
    this.header = page.header;
    this.scene = page.scene;
    element("panel").open = !window.matchMedia(SMALL).matches;
    this.colours();
    this.references();
    this.traces();
    this.ticks();
    this.cautions();
    this.bodies();
    this.plots();
    element("scale").disabled = !this.header.fields.length;
    this.listen("scale", "input", () => this.scale());
    element("reset").addEventListener("click", () => { page.camera.reset(); page.redraw(); });
  }

  listen(name, kind, act) {
    element(name).addEventListener(kind, () => { act(); this.page.redraw(); });
    act();
  }

  // What bodies lack, such as why there are no stresses.
  cautions() {
    const { cautions } = this.header;
    element("cautions").hidden = !cautions.length;
    element("cautions").lastElementChild.replaceChildren(...cautions.map((text) => {
      const item = document.createElement("li");
      item.textContent = text;
      return item;
    }));
  }

  colours() {
    const { fields, colour } = this.header;
    const known = [["body", "body"], ...fields.map((field) => [field.name, field.title])];
    fill(element("colour"), known, colour || (fields.length ? fields[0].name : "body"));
    this.listen("colour", "change", () => this.page.legend.choose(element("colour").value));
  }

  references() {
    const { header, scene } = this, select = element("reference");
    const nodes = [...new Set(scene.bodies.filter((body) => !body.rigid).flatMap(
      (body) => body.held.map((held) => held.node)))];
    const given = [...new Set(scene.bodies.map((body) => body.reference).filter(
      (node) => node !== null).map(
      (at) => [].concat(at).map((node) => header.nodes[node].name).join(" - ")))];
    const rest = given.length ? `support: ${given.slice(0, 2).join(", ")}`
      + (given.length > 2 ? ", ..." : "") : "floating frame";
    const known = [["default", rest], ...(given.length ? [["frame", "floating frame"]] : []),
                   ...nodes.map((node) => [node, `node ${header.nodes[node].name}`])];
    fill(select, known, "default");
    select.disabled = !header.fields.length;
    select.addEventListener("change", () => {
      const { value } = select;
      scene.references.choose(Number.isNaN(Number(value)) ? value : Number(value));
      scene.stale();
      this.page.legend.measured(value === "default");
      this.page.redraw();
    });
  }

  traces() {
    const { header, scene } = this;
    const named = header.nodes.map((node, k) => [k, node.name]).filter(
      ([k]) => !header.nodes[k].ground);
    fill(element("trace"), [["", "no node"], ...named, ["all", "all nodes"]], header.trace ?? "");
    this.listen("trace", "change", () => {
      const { value } = element("trace");
      scene.shown.trace = value === "all" ? named.map(([k]) => k)
        : value === "" ? [] : [Number(value)];
    });
  }

  ticks() {
    const { labels } = this.page;
    const of = { "node-names": [labels.shown, "nodes"], "body-names": [labels.shown, "bodies"] };
    for (const box of element("ticks").querySelectorAll("input")) {
      const [shown, name] = of[box.id] || [this.scene.shown, box.id];
      this.listen(box.id, "change", () => { shown[name] = box.checked; });
    }
    element("loads").parentElement.hidden = !this.header.arrows.length;
    element("contacts").parentElement.hidden = !this.header.contacts.length;
  }

  // A line for each body: whether it is shown, and its colour.
  bodies() {
    element("bodies").hidden = !this.scene.entries.length;
    element("list").replaceChildren(...this.scene.entries.map((entry) => {
      const row = document.createElement("label"), seen = document.createElement("input");
      const colour = document.createElement("input"), name = document.createElement("span");
      Object.assign(seen, { type: "checkbox", checked: true });
      Object.assign(colour, { type: "color", value: entry.colour,
                              title: `colour of ${entry.name}` });
      name.textContent = entry.name;
      seen.addEventListener("change", () => {
        entry.visible = seen.checked;
        this.page.redraw();
      });
      colour.addEventListener("input", () => {
        entry.paint = rgb(colour.value);
        this.page.redraw();
      });
      row.append(seen, colour, name);
      return row;
    }));
  }

  scale() {
    const factor = 10 ** (Number(element("scale").value) / DISPLAYED_SCALES);
    this.scene.shown.scale = factor;
    element("scale-value").textContent = `\u00d7 ${Number(factor.toPrecision(2))}`;
  }

  // What is plotted: first whose quantity, then which.
  plots() {
    const { all, left } = this.header.plots, owner = element("owner");
    const owners = [...new Set(all.map((plot) => plot.owner))];
    fill(owner, owners.map((name) => [name, name]), owners[0]);
    if (left) owner.title = `${left} more quantities do not fit on the page: name them to sebody animate`;
    const choose = () => {
      this.page.plot.choose(Number(element("quantity").value));
      this.page.redraw();
    };
    const offer = () => {
      const own = all.map((plot, k) => [k, plot]).filter(([, plot]) => plot.owner === owner.value);
      const before = element("quantity").selectedOptions[0]?.text;
      const options = own.map(([k, plot]) => [k, plot.name.startsWith(`${plot.owner}.`)
        ? plot.name.slice(plot.owner.length + 1).replaceAll("_", " ") : plot.name]);
      const same = options.find(([, text]) => text === before) || options[0];
      if (same) fill(element("quantity"), options, same[0]);
      choose();
    };
    owner.addEventListener("change", offer);
    element("quantity").addEventListener("change", choose);
    offer();
  }
}
