"use strict";
// The page of a grainfield report: draws the figures with Plotly and the particle maps on a canvas
// under Plotly's axes. All data come from the JSON block #report-data; texts are only ever set as
// text. What is in sight is drawn first (data-opened: milliseconds until then), the rest one figure an
// idle moment. When everything is drawn <html> gets data-ready = number of plots; problems are
// collected in data-errors.
(() => {
  const root = document.documentElement;
  const problem = (text) => {
    root.dataset.errors = (root.dataset.errors ? root.dataset.errors + "\n" : "") + text;
  };
  window.addEventListener("error", (event) => problem(event.message || "a resource failed"));
  window.addEventListener("unhandledrejection", (event) => problem(String(event.reason)));
  document.addEventListener("securitypolicyviolation", (event) =>
    problem("refused by the content security policy: " + event.violatedDirective));

  const font = { family: "system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif", size: 13, color: "#1a1a1a" };
  const paper = { width: 640, height: 380 };  // CSS pixels of a figure in print
  const touch = window.matchMedia("(pointer: coarse)").matches;
  const config = (scrollZoom) => ({
    responsive: true,
    displaylogo: false,
    plotlyServerURL: "",
    showSendToCloud: false,
    scrollZoom,
    modeBarButtons: [["zoom2d", "pan2d", "zoomIn2d", "zoomOut2d", "resetScale2d", ...(scrollZoom ? [] : ["toImage"])]],
    toImageButtonOptions: { format: "svg" },
  });

  function element(name, properties = {}, ...children) {
    const node = Object.assign(document.createElement(name), properties);
    node.append(...children);
    return node;
  }

  // ---- curves -------------------------------------------------------------------------------

  // A button that shows or hides a run or a kind; the swatch shows its colour and dashes.
  function legendButton(entry, shown, onChange) {
    const swatch = element("span", { className: "swatch " + (entry.dash || "block") });
    swatch.style.color = entry.colour;
    const button = element("button", { type: "button" }, swatch, entry.label);
    const show = (value) => {
      button.setAttribute("aria-pressed", String(value));
      button.title = value ? "Hide" : "Show";
    };
    show(shown);
    button.addEventListener("click", () => {
      const value = button.getAttribute("aria-pressed") !== "true";
      show(value);
      onChange(value);
    });
    return button;
  }

  function fillLegend(legend, figure, plot) {
    const runShown = figure.runs.map(() => true);
    const kindShown = figure.kinds.map((kind) => kind.shown);
    const isGuide = (kind) => figure.kinds[kind].guide;
    const runButtons = new Map();
    const update = () =>
      Plotly.restyle(plot, {
        visible: figure.traces.map(
          ({ meta }) => kindShown[meta.kind] && (isGuide(meta.kind) || runShown[meta.run])),
      });
    const present = new Set(figure.traces.filter((t) => !isGuide(t.meta.kind)).map((t) => t.meta.run));
    if (figure.runs.length > 1) {
      const row = element("div", { className: "runs" });
      figure.runs.forEach((run, r) => {
        if (!present.has(r)) return;
        const button = legendButton(run, true, (value) => { runShown[r] = value; update(); });
        runButtons.set(r, button);
        row.append(button);
      });
      legend.append(row);
    }
    // All runs of one origin at once.
    const groups = (figure.groups || []).map((group) => ({
      label: group.label, runs: group.runs.filter((r) => present.has(r)),
    })).filter((group) => group.runs.length > 1);
    if (groups.length > 1) {
      const row = element("div", { className: "groups" });
      for (const group of groups) {
        row.append(legendButton({ label: "all " + group.label, colour: "#777" }, true, (value) => {
          for (const r of group.runs) {
            runShown[r] = value;
            runButtons.get(r).setAttribute("aria-pressed", String(value));
          }
          update();
        }));
      }
      legend.append(row);
    }
    if (figure.kinds.length > 1) {
      const row = element("div", { className: "kinds" });
      figure.kinds.forEach((kind, k) =>
        row.append(legendButton(kind, kind.shown, (value) => { kindShown[k] = value; update(); })));
      legend.append(row);
    }
  }

  function addScaleToggle(tools, figure, plot) {
    const button = element("button", { type: "button" }, "Linear axes");
    button.setAttribute("aria-pressed", "false");
    button.addEventListener("click", () => {
      const linear = button.getAttribute("aria-pressed") !== "true";
      button.setAttribute("aria-pressed", String(linear));
      const type = (axis) => (linear ? "linear" : figure.layout[axis].type);
      Plotly.relayout(plot, {
        "xaxis.type": type("xaxis"), "yaxis.type": type("yaxis"),
        "xaxis.autorange": true, "yaxis.autorange": true,
      });
    });
    tools.append(button);
  }

  const plotOf = (figure) => document.getElementById("plot-" + figure.name);

  // `size`: in print, where there is no time to fit the window.
  function drawFigure(figure, size = {}) {
    const plot = plotOf(figure);
    const box = plot.closest("figure");
    const layout = {
      ...figure.layout, ...size,
      font, showlegend: false, hovermode: "closest",
      dragmode: touch ? false : "zoom",
      margin: { l: 62, r: 14, t: 12, b: 50 },
      paper_bgcolor: "#fff", plot_bgcolor: "#fff",
    };
    return Plotly.newPlot(plot, figure.traces, layout, config(false)).then(() => {
      fillLegend(box.querySelector(".legend"), figure, plot);
      window.addEventListener("beforeprint", () => Plotly.relayout(plot, { ...paper, autosize: false }));
      window.addEventListener("afterprint", () =>
        Plotly.relayout(plot, { width: null, height: null, autosize: true }));
      if (figure.toggle) addScaleToggle(box.querySelector(".tools"), figure, plot);
    });
  }

  // Draws the figures that are in sight, then calls `opened`, then draws the rest, the nearest first.
  // Printing does not wait for that: it draws what is missing at once.
  async function drawFigures(figures, together, opened) {
    const distance = (figure) => {
      const area = plotOf(figure).getBoundingClientRect();
      return Math.max(0, area.top - window.innerHeight, -area.bottom);
    };
    const missing = new Set(figures);
    const drawn = [];
    const draw = (figure, size) => {
      missing.delete(figure);
      drawn.push(drawFigure(figure, size));
      return drawn.at(-1);
    };
    window.addEventListener("beforeprint", () => {
      for (const figure of [...missing]) draw(figure, { ...paper, autosize: false });
    });
    const inSight = figures.filter((figure) => distance(figure) === 0);
    await Promise.all([together, ...inSight.map((figure) => draw(figure))]);
    opened();
    while (missing.size) {
      await new Promise((done) => setTimeout(done));
      const nearest = [...missing].sort((a, b) => distance(a) - distance(b))[0];
      if (nearest) await draw(nearest);
    }
    await Promise.all(drawn);
  }

  // ---- particle maps ------------------------------------------------------------------------

  const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));

  // Positions and colour levels of a map; particles of one level are drawn as one path.
  function unpack(map) {
    if (map.levels) return;
    const view = new DataView(bytes(map.points).buffer);
    const count = view.byteLength / 4;
    const scale = (range) => (range[1] - range[0]) / 65535;
    const [sx, sy] = [scale(map.pointsX), scale(map.pointsY)];
    map.px = new Float32Array(count);
    map.py = new Float32Array(count);
    map.q = bytes(map.order);
    map.layer = bytes(map.layers);
    const identity = new DataView(bytes(map.ids).buffer);
    map.identity = Array.from({ length: identity.byteLength / 4 }, (_, i) => identity.getUint32(4 * i, true));
    map.levels = Array.from({ length: 256 }, () => []);
    for (let i = 0; i < count; i++) {
      map.px[i] = map.pointsX[0] + sx * view.getUint16(4 * i, true);
      map.py[i] = map.pointsY[0] + sy * view.getUint16(4 * i + 2, true);
      map.levels[map.q.length ? map.q[i] : 255].push(i);
    }
    if (map.image) {
      map.picture = new Image();
      map.loaded = new Promise((done) => {
        map.picture.onload = done;
        map.picture.onerror = () => { problem("a preview image cannot be decoded"); done(); };
      });
      map.picture.src = map.image;
    }
  }

  // Identities get colours that neighbours in number do not share.
  const hues = Array.from({ length: 48 }, (_, i) => `hsl(${(i * 137.5) % 360} 65% ${40 + 8 * (i % 3)}%)`);

  // One small map of each run side by side: discs at 85 % of the diameter, or the picture of a field
  // or of a frame that nothing was found in.
  function drawGallery(maps, colours, labels, pick) {
    const gallery = document.querySelector(".gallery");
    if (!gallery) return;
    const seen = new Map();
    for (const map of maps) {
      const known = seen.get(map.run) || [];
      if (known.length === 0 || (map.is_field && known.length < 2)) seen.set(map.run, [...known, map]);
    }
    for (const map of [...seen.values()].flat()) {
      const side = 230;
      const aspect = (map.y[1] - map.y[0]) / (map.x[1] - map.x[0]);
      const canvas = element("canvas", { width: 2 * side, height: Math.round(2 * side * Math.min(aspect, 2)) });
      const button = element("button", { type: "button", title: "Show large" }, canvas,
        element("span", {}, labels[map.run] + (map.is_field ? ": " + map.title.split(" from ")[0] : ", " + map.title.split(",")[0])));
      button.addEventListener("click", () => pick(map.run));
      gallery.append(button);
      const draw = () => {
        unpack(map);
        const context = canvas.getContext("2d");
        const scale = canvas.width / (map.x[1] - map.x[0]);
        if (map.loaded && (map.is_field || !map.px.length)) {
          map.loaded.then(() => context.drawImage(map.picture, 0, 0,
            map.imageSize[0] * scale, map.imageSize[1] * scale));
          return;
        }
        const r = Math.max(0.8, 0.5 * 0.85 * map.diameter * scale);
        map.levels.forEach((members, level) => {
          if (!members.length) return;
          context.fillStyle = level === 255 ? "#999999" : colours[level];
          context.beginPath();
          for (const i of members) {
            const x = (map.px[i] - map.x[0]) * scale;
            const y = (map.yDown ? map.py[i] - map.y[0] : map.y[1] - map.py[i]) * scale;
            if (r < 1.5) {
              context.rect(x - r, y - r, 2 * r, 2 * r);
            } else {
              context.moveTo(x + r, y);
              context.arc(x, y, r, 0, 2 * Math.PI);
            }
          }
          context.fill();
        });
      };
      waitingMaps.push(draw);
    }
  }
  const waitingMaps = [];  // drawn once the page stands, one an idle moment

  function drawMaps(maps, colours, labels) {
    const box = document.getElementById("map");
    if (!box) return Promise.resolve();
    const plot = box.querySelector(".plot");
    const canvas = box.querySelector("canvas");
    const readout = box.querySelector(".readout");
    const select = {
      run: box.querySelector(".pick-run"), frame: box.querySelector(".pick-frame"),
      colour: box.querySelector(".pick-colour"), trails: box.querySelector(".trails"),
    };
    let map = maps[0];
    let frames = [];  // the maps of the run shown
    let marks = "discs";
    let colouring = "order";
    let waiting = 0;
    const margin = { l: 52, r: 8, t: 8, b: 44 };

    // Plotly's axes, in CSS pixels of the plot.
    function frame() {
      const { xaxis, yaxis } = plot._fullLayout;
      return {
        left: xaxis._offset, top: yaxis._offset, width: xaxis._length, height: yaxis._length,
        x: (v) => xaxis._offset + xaxis.l2p(v), y: (v) => yaxis._offset + yaxis.l2p(v),
        scale: xaxis._length / Math.abs(xaxis.range[1] - xaxis.range[0]),
      };
    }

    function addMark(context, x, y, r) {
      if (marks === "centres") {
        context.rect(x - 1.25, y - 1.25, 2.5, 2.5);
      } else if (r < 1.2) {
        context.rect(x - r, y - r, 2 * r, 2 * r);
      } else {
        context.moveTo(x + r, y);
        context.arc(x, y, r, 0, 2 * Math.PI);
      }
    }

    // Particles that are drawn alike, by colour.
    function classes() {
      const out = new Map();
      const put = (colour, i) => {
        if (!out.has(colour)) out.set(colour, []);
        out.get(colour).push(i);
      };
      if (colouring === "identity" && map.identity.length) {
        map.identity.forEach((id, i) => put(hues[id % hues.length], i));
      } else if (colouring === "layer" && map.layer.length) {
        map.layer.forEach((layer, i) => put(["#0072b2", "#d55e00"][layer] || "#999999", i));
      } else {
        map.levels.forEach((members, level) => {
          // Levels may share a colour.
          for (const i of members) put(level === 255 ? "#999999" : colours[level], i);
        });
      }
      return out;
    }

    // Where each particle was in the frames before this one, as far as they are on the page.
    function paintTrails(context, f) {
      const at = frames.indexOf(map);
      if (select.trails.getAttribute("aria-pressed") !== "true" || at < 1 || !map.identity.length) return;
      context.strokeStyle = "#e8590c";
      context.lineWidth = Math.max(1, 0.06 * map.diameter * f.scale);
      const reach = 3 * map.diameter;  // a longer step is a boundary crossed, or an identity lost
      context.beginPath();
      for (let n = at; n > 0; n--) {
        unpack(frames[n - 1]);
        const before = new Map(frames[n - 1].identity.map((id, i) => [id, i]));
        frames[n].identity.forEach((id, i) => {
          const j = before.get(id);
          if (j === undefined) return;
          const [x0, y0, x1, y1] = [frames[n - 1].px[j], frames[n - 1].py[j], frames[n].px[i], frames[n].py[i]];
          if (Math.hypot(x1 - x0, y1 - y0) > reach) return;
          context.moveTo(f.x(x0), f.y(y0));
          context.lineTo(f.x(x1), f.y(y1));
        });
      }
      context.stroke();
    }

    function paint() {
      waiting = 0;
      const ratio = window.devicePixelRatio || 1;
      const [width, height] = [plot.clientWidth, plot.clientHeight];
      if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
        canvas.width = Math.round(width * ratio);
        canvas.height = Math.round(height * ratio);
        canvas.style.width = width + "px";
        canvas.style.height = height + "px";
      }
      const context = canvas.getContext("2d");
      const f = frame();
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      context.clearRect(0, 0, width, height);
      context.save();
      context.beginPath();
      context.rect(f.left, f.top, f.width, f.height);
      context.clip();
      if (map.picture && map.picture.complete && map.picture.naturalWidth) {
        context.imageSmoothingEnabled = f.scale * ratio < 2;
        context.drawImage(map.picture, f.x(-0.5), f.y(-0.5),
          map.imageSize[0] * f.scale, map.imageSize[1] * f.scale);
      }
      if (marks !== "none") {
        const r = 0.5 * 0.85 * map.diameter * f.scale;
        for (const [colour, members] of classes()) {
          context.beginPath();
          for (const i of members) {
            const x = f.x(map.px[i]);
            const y = f.y(map.py[i]);
            if (x < f.left - r || x > f.left + f.width + r || y < f.top - r || y > f.top + f.height + r) continue;
            addMark(context, x, y, r);
          }
          // Outlines and centres are for judging the detection: they must show on black and white.
          const plain = (marks === "outlines" || marks === "centres") && colouring === "order";
          context.fillStyle = context.strokeStyle = plain ? "#e8590c" : colour;
          if (marks === "outlines") {
            context.lineWidth = 1.5;
            context.stroke();
          } else {
            context.fill();
          }
        }
        paintTrails(context, f);
      }
      context.restore();
    }
    const repaint = () => { waiting = waiting || requestAnimationFrame(paint); };

    function say(event) {
      const area = plot.getBoundingClientRect();
      const f = frame();
      const [mx, my] = [event.clientX - area.left, event.clientY - area.top];
      let best = -1;
      let least = Math.max(6, 0.5 * map.diameter * f.scale) ** 2;
      for (let i = 0; i < map.px.length; i++) {
        const d = (f.x(map.px[i]) - mx) ** 2 + (f.y(map.py[i]) - my) ** 2;
        if (d < least) [best, least] = [i, d];
      }
      if (best < 0) { readout.textContent = ""; return; }
      const q = map.q.length ? map.q[best] : 255;
      readout.textContent = `x = ${map.px[best].toFixed(1)} ${map.unit}, y = ${map.py[best].toFixed(1)} ${map.unit}` +
        (q === 255 ? "" : `, ${map.orderName} = ${(q / 254).toFixed(2)}`);
    }

    function heightFor(wide) {
      const aspect = (map.y[1] - map.y[0]) / (map.x[1] - map.x[0]);
      return (wide - margin.l - margin.r) * aspect + margin.t + margin.b;
    }

    function layout() {
      const tall = Math.max(320, 0.82 * window.innerHeight);
      const height = Math.min(heightFor(box.querySelector(".stage").clientWidth), tall);
      const axis = (title) => ({
        title: { text: `${title} [${map.unit}]`, standoff: 6 }, showgrid: false, zeroline: false,
        ticks: "outside", showline: true, mirror: true, linecolor: "#888", constrain: "domain",
      });
      return {
        font, margin, height, dragmode: "pan", showlegend: false, hovermode: false,
        paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
        modebar: { bgcolor: "rgba(255,255,255,0.85)", color: "#666", activecolor: "#0072b2" },
        xaxis: { ...axis("x"), range: map.x.slice() },
        yaxis: { ...axis("y"), range: map.yDown ? map.y.slice().reverse() : map.y.slice(), scaleanchor: "x" },
      };
    }

    async function show(next) {
      map = next;
      unpack(map);
      const caption = box.querySelector(".caption");
      caption.textContent = map.title;
      caption.classList.toggle("paper", !select.frame.parentElement.hidden);
      box.querySelector(".colour-bar").hidden = map.q.length === 0;
      box.querySelector(".colour-bar .order").textContent = map.orderName;
      readout.textContent = "";
      await Plotly.react(plot, [{ type: "scatter", x: [], y: [] }], layout(), config(true));
      await map.loaded;
      paint();
    }

    function listFrames(run) {
      frames = maps.filter((m) => m.run === run);
      select.frame.max = String(frames.length - 1);
      select.frame.value = "0";
      select.frame.parentElement.hidden = frames.length < 2;
      const has = (column) => frames.some((m) => m[column]);
      select.trails.hidden = frames.length < 2 || !has("ids");
      const option = (value) => [...select.colour.options].find((o) => o.value === value);
      option("identity").hidden = !has("ids");
      option("layer").hidden = !has("layers");
      if (option(colouring).hidden) select.colour.value = colouring = "order";
      select.colour.parentElement.hidden = !has("ids") && !has("layers");
      return frames[0];
    }

    select.run.addEventListener("change", () => show(listFrames(Number(select.run.value))));
    select.frame.addEventListener("input", () => show(frames[Number(select.frame.value)]));
    select.colour.addEventListener("change", () => { colouring = select.colour.value; paint(); });
    select.trails.addEventListener("click", () => {
      select.trails.setAttribute("aria-pressed", String(select.trails.getAttribute("aria-pressed") !== "true"));
      paint();
    });
    const pick = (run) => {
      select.run.value = String(run);
      box.scrollIntoView({ block: "nearest" });
      return show(listFrames(run));
    };
    drawGallery(maps, colours, labels, pick);
    box.querySelectorAll(".marks button").forEach((button) =>
      button.addEventListener("click", () => {
        box.querySelectorAll(".marks button").forEach((other) =>
          other.setAttribute("aria-pressed", String(other === button)));
        marks = button.value;
        paint();
      }));
    plot.addEventListener("pointermove", say);
    plot.addEventListener("pointerleave", () => { readout.textContent = ""; });

    return show(listFrames(maps[0].run)).then(() => {
      for (const event of ["plotly_relayouting", "plotly_relayout", "plotly_redraw", "plotly_afterplot"]) {
        plot.on(event, repaint);
      }
      window.addEventListener("resize", () => Plotly.relayout(plot, { height: layout().height }));
      window.addEventListener("beforeprint", () => {
        Plotly.relayout(plot, { width: paper.width, height: Math.min(heightFor(paper.width), 800), autosize: false });
        paint();
      });
      window.addEventListener("afterprint", () =>
        Plotly.relayout(plot, { width: null, height: layout().height, autosize: true }));
    });
  }

  document.addEventListener("DOMContentLoaded", async () => {
    try {
      const data = JSON.parse(document.getElementById("report-data").textContent);
      await drawFigures(data.figures, drawMaps(data.maps, data.colours, data.runs), () => {
        root.dataset.opened = String(Math.round(performance.now()));
      });
      root.dataset.milliseconds = String(Math.round(performance.now()));
      root.dataset.ready = String(document.querySelectorAll(".js-plotly-plot").length);
      const next = () => { const draw = waitingMaps.shift(); if (draw) { draw(); setTimeout(next, 0); } };
      next();
    } catch (error) {
      problem(String(error && error.stack || error));
    }
  });
})();
