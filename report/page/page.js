"use strict";
// The page of a grainfield report: draws the figures with Plotly and the particle maps on a canvas
// under Plotly's axes. All data come from the JSON block #report-data; texts are only ever set as
// text. It runs as soon as it is read: images of runs that are not shown at first follow it, in the
// block #report-images. What is in sight is drawn first (data-opened: milliseconds until then), the rest one figure an
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
    const swatch = entry.symbol
      ? element("span", { className: "glyph" }, entry.symbol)
      : element("span", { className: "swatch " + (entry.dash || "block") });
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

  // Resolved when the images that follow this script are known. Until then those of their maps are null.
  function followingImages(maps) {
    const read = document.readyState !== "loading" ? Promise.resolve()
      : new Promise((done) => document.addEventListener("DOMContentLoaded", done));
    return read.then(() => {
      const block = document.getElementById("report-images");
      for (const [m, image] of Object.entries(block ? JSON.parse(block.textContent) : {})) maps[m].image = image;
    }).catch((error) => problem("images cannot be read: " + error)).then(() => {
      for (const map of maps) map.image ??= "";
    });
  }

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

  // The pictures: one view a run, two side by side where there are several, on one scale of lengths.
  // Marks, colours, frame, zoom and lens are shared.
  function drawMaps(maps, colours, labels, images) {
    const box = document.getElementById("map");
    if (!box) return Promise.resolve();
    const readout = box.querySelector(".readout");
    const slider = box.querySelector(".pick-frame");
    const select = {
      colour: box.querySelector(".pick-colour"), trails: box.querySelector(".trails"),
      lens: box.querySelector(".lens-switch"),
    };
    const margin = { l: 42, r: 6, t: 4, b: 26 };
    const lensSize = 150;  // CSS pixels
    const ink = "#c2410c";  // of marks whose colour would say nothing
    // Of the rim about an outline: what the colour shows against on black, on white and in grey.
    const rimOf = (colour) => {
      const [r, g, b] = [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
      return 0.3 * r + 0.59 * g + 0.11 * b > 150 ? "rgba(0,0,0,0.8)" : "rgba(255,255,255,0.85)";
    };
    let marks = "outlines";
    let colouring = "order";
    const isPressed = (button) => button.getAttribute("aria-pressed") === "true";
    const views = [...box.querySelectorAll(".view")].map(makeView);

    // Particles that are drawn alike, by colour.
    function classes(map) {
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

    function addMark(context, kind, x, y, r) {
      if (kind === "centres") {
        context.rect(x - 1.25, y - 1.25, 2.5, 2.5);
      } else if (r < 1.2) {
        context.rect(x - r, y - r, 2 * r, 2 * r);
      } else {
        context.moveTo(x + r, y);
        context.arc(x, y, r, 0, 2 * Math.PI);
      }
    }

    // Picture and marks of a map; `f` says where a place lies on the canvas and how large a length is.
    function paintMap(context, map, f, ratio, kind) {
      if (map.picture && map.picture.complete && map.picture.naturalWidth) {
        context.imageSmoothingEnabled = f.scale * ratio < 2;
        context.drawImage(map.picture, f.x(map.x[0]), f.y(map.yDown ? map.y[0] : map.y[1]),
          map.imageSize[0] * f.scale, map.imageSize[1] * f.scale);
      }
      if (kind === "none") return;
      const r = 0.5 * 0.85 * map.diameter * f.scale;
      for (const [colour, members] of classes(map)) {
        context.beginPath();
        for (const i of members) {
          const x = f.x(map.px[i]);
          const y = f.y(map.py[i]);
          if (x < f.left - r || x > f.left + f.width + r || y < f.top - r || y > f.top + f.height + r) continue;
          addMark(context, kind, x, y, r);
        }
        // The order of a particle, where it has one.
        const plain = kind !== "discs" && colouring === "order" && !map.q.length;
        context.globalAlpha = kind === "outlines" && map.picture && r < 4 ? 0.6 : 1;
        context.fillStyle = context.strokeStyle = plain ? ink : colour;
        if (kind === "outlines") {
          if (map.picture && r > 7) {
            context.strokeStyle = colour.startsWith("#") && !plain ? rimOf(colour) : "rgba(255,255,255,0.75)";
            context.lineWidth = 3.2;
            context.stroke();
            context.strokeStyle = plain ? ink : colour;
          }
          context.lineWidth = r > 7 ? 1.8 : r > 3 ? 1.5 : 1;
          context.stroke();
        } else {
          context.fill();
        }
      }
      context.globalAlpha = 1;
    }

    // Tells space.js what a view shows.
    const tell = (view) => document.dispatchEvent(new CustomEvent("map-shown", { detail: {
      view: views.indexOf(view), map: view.map, caption: `${labels[view.map.run]}, ${view.map.title}`,
      colours: () => {
        const out = [];
        for (const [colour, members] of classes(view.map)) for (const i of members) out[i] = colour;
        return out;
      },
    } }));

    // Index of each identity in a map.
    const whereOf = (map) => {
      map.where = map.where || new Map(map.identity.map((id, i) => [id, i]));
      return map.where;
    };

    // What the buttons of its places say, "" where there is none.
    const numbersOf = (map) => {
      map.numbers = map.numbers || map.places.map((_, p) => {
        const button = box.querySelector(`.place[value="${maps.indexOf(map)} ${p}"]`);
        return button ? button.textContent : "";
      });
      return map.numbers;
    };

    function makeView(root) {
      const plot = root.querySelector(".plot");
      const stage = root.querySelector(".stage");
      const canvas = root.querySelector("canvas:not(.lens)");
      const lens = root.querySelector(".lens");
      const pick = root.querySelector(".pick-run");
      const view = { root, plot, stage, pick, map: null, frames: [], at: null, boxes: [] };
      let waiting = 0;

      // Plotly's axes, in CSS pixels of the plot.
      view.frame = () => {
        const { xaxis, yaxis } = plot._fullLayout;
        return {
          left: xaxis._offset, top: yaxis._offset, width: xaxis._length, height: yaxis._length,
          x: (v) => xaxis._offset + xaxis.l2p(v), y: (v) => yaxis._offset + yaxis.l2p(v),
          toX: (p) => xaxis.p2l(p - xaxis._offset), toY: (p) => yaxis.p2l(p - yaxis._offset),
          scale: xaxis._length / Math.abs(xaxis.range[1] - xaxis.range[0]),
        };
      };

      // Where each particle was in the frames before this one, as far as they are on the page.
      function paintTrails(context, f) {
        const { map, frames } = view;
        const at = frames.indexOf(map);
        if (!isPressed(select.trails) || at < 1 || !map.identity.length) return;
        context.strokeStyle = "#e8590c";
        context.lineWidth = Math.max(1, 0.06 * map.diameter * f.scale);
        const reach = 3 * map.diameter;  // a longer step is a boundary crossed, or an identity lost
        context.beginPath();
        for (let n = at; n > 0; n--) {
          unpack(frames[n - 1]);
          const before = whereOf(frames[n - 1]);
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

      view.paint = () => {
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
        const f = view.frame();
        context.setTransform(ratio, 0, 0, ratio, 0, 0);
        context.clearRect(0, 0, width, height);
        context.save();
        context.beginPath();
        context.rect(f.left, f.top, f.width, f.height);
        context.clip();
        paintMap(context, view.map, f, ratio, marks);
        if (marks !== "none") paintTrails(context, f);
        // What space.js shows from the side.
        for (const [colour, wide, dash] of [["#fff", 3, []], ["#111", 1.2, [5, 4]]]) {
          context.strokeStyle = colour;
          context.lineWidth = wide;
          context.setLineDash(dash);
          for (const [x0, y0, x1, y1] of view.boxes) {
            context.strokeRect(f.x(x0), f.y(y0), f.x(x1) - f.x(x0), f.y(y1) - f.y(y0));
          }
        }
        context.setLineDash([]);
        // Numbered rims of the places to look at.
        context.font = "600 12px system-ui, sans-serif";
        view.map.places.forEach(([px, py], p) => {
          const r = Math.max(9, 1.2 * view.map.diameter * f.scale);
          for (const [colour, wide] of [["#fff", 4], ["#111", 1.6]]) {
            context.strokeStyle = colour;
            context.lineWidth = wide;
            context.strokeRect(f.x(px) - r, f.y(py) - r, 2 * r, 2 * r);
          }
          const number = numbersOf(view.map)[p];
          if (!number) return;
          context.lineWidth = 3;
          context.strokeStyle = "#fff";
          context.strokeText(number, f.x(px) + r + 2, f.y(py) - r + 10);
          context.fillStyle = "#111";
          context.fillText(number, f.x(px) + r + 2, f.y(py) - r + 10);
        });
        context.restore();
        view.paintLens();
      };
      view.repaint = () => { waiting = waiting || requestAnimationFrame(view.paint); };

      // The picture about `view.at`, several times larger, with thin outlines.
      view.paintLens = () => {
        const isOn = isPressed(select.lens) && view.at && view.map && !view.map.is_field;
        lens.hidden = !isOn;
        if (!isOn) return;
        const ratio = window.devicePixelRatio || 1;
        lens.width = lens.height = lensSize * ratio;
        const f = view.frame();
        const [x, y] = view.at;
        const map = view.map;
        const scale = Math.max(3 * f.scale, 42 / map.diameter);
        const down = map.yDown ? 1 : -1;
        const context = lens.getContext("2d");
        context.setTransform(ratio, 0, 0, ratio, 0, 0);
        context.fillStyle = "#fff";
        context.fillRect(0, 0, lensSize, lensSize);
        paintMap(context, map, {
          left: 0, top: 0, width: lensSize, height: lensSize, scale,
          x: (v) => lensSize / 2 + (v - x) * scale, y: (v) => lensSize / 2 + down * (v - y) * scale,
        }, ratio, marks === "discs" ? "outlines" : marks);
        lens.style.left = f.x(x) - lensSize / 2 + "px";
        lens.style.top = f.y(y) - lensSize / 2 + "px";
      };

      view.describe = (px, py) => {
        const { map } = view;
        const f = view.frame();
        let best = -1;
        let least = Math.max(6, 0.5 * map.diameter * f.scale) ** 2;
        for (let i = 0; i < map.px.length; i++) {
          const d = ((map.px[i] - px) * f.scale) ** 2 + ((map.py[i] - py) * f.scale) ** 2;
          if (d < least) [best, least] = [i, d];
        }
        if (best < 0) return "";
        const q = map.q.length ? map.q[best] : 255;
        return `x = ${map.px[best].toFixed(1)} ${map.unit}, y = ${map.py[best].toFixed(1)} ${map.unit}` +
          (q === 255 ? "" : `, ${map.orderName} = ${(q / 254).toFixed(2)}`);
      };

      view.height = () => {
        const wide = stage.clientWidth;
        const map = view.map;
        const aspect = (map.y[1] - map.y[0]) / (map.x[1] - map.x[0]);
        const full = (wide - margin.l - margin.r) * aspect + margin.t + margin.b;
        // On a wide screen picture, slider and places end with the first screen.
        const top = stage.getBoundingClientRect().top + window.scrollY;
        const below = 92;
        const room = window.innerWidth > 820 && top < 0.5 * window.innerHeight
          ? window.innerHeight - top - below : 0.82 * window.innerHeight;
        return Math.min(full, Math.max(320, room));
      };

      view.layout = () => {
        const map = view.map;
        const axis = () => ({
          showgrid: false, zeroline: false,
          ticks: "outside", showline: true, mirror: true, linecolor: "#888",
          constrain: "range",  // shows more than asked for where shapes differ, never less
        });
        return {
          font, margin, height: view.height(), dragmode: touch ? false : "pan", showlegend: false, hovermode: false,
          paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
          modebar: { bgcolor: "rgba(255,255,255,0.85)", color: "#666", activecolor: "#0072b2" },
          xaxis: { ...axis(), range: map.x.slice() },
          yaxis: { ...axis(), range: map.yDown ? map.y.slice().reverse() : map.y.slice(), scaleanchor: "x" },
        };
      };

      view.show = async (next) => {
        const old = view.map;
        view.map = next;
        unpack(next);
        root.querySelector(".caption").textContent = `${next.title}; axes in ${next.unit}`;
        const layout = view.layout();
        // Another frame of the run keeps the zoom.
        const isSame = old && old.run === next.run && String(old.x) === String(next.x);
        if (isSame && plot._fullLayout) {
          layout.xaxis.range = plot._fullLayout.xaxis.range.slice();
          layout.yaxis.range = plot._fullLayout.yaxis.range.slice();
        }
        await Plotly.react(plot, [{ type: "scatter", x: [], y: [] }], layout,
          { ...config(true), displayModeBar: false });
        await next.loaded;
        view.paint();
        tell(view);
      };

      // What is in sight: its centre, in diameters from that of the picture, y downwards, and how large
      // a diameter is there [CSS pixels]. The same for all views, whatever their units and shapes.
      const centre = (range) => (range[0] + range[1]) / 2;
      view.window = () => {
        const { map } = view;
        const { xaxis, yaxis } = plot._fullLayout;
        const down = map.yDown ? 1 : -1;
        return [(centre(xaxis.range) - centre(map.x)) / map.diameter,
          down * (centre(yaxis.range) - centre(map.y)) / map.diameter,
          view.frame().scale * map.diameter];
      };
      view.look = ([u, v, size]) => {
        const { map } = view;
        const down = map.yDown ? 1 : -1;
        const x = centre(map.x) + u * map.diameter;
        const y = centre(map.y) + down * v * map.diameter;
        const { xaxis, yaxis } = plot._fullLayout;
        const half = 0.5 * xaxis._length * map.diameter / size;
        const tall = 0.5 * yaxis._length * map.diameter / size;
        return Plotly.relayout(plot, {
          "xaxis.range": [x - half, x + half],
          "yaxis.range": map.yDown ? [y + tall, y - tall] : [y - tall, y + tall],
        });
      };
      view.reset = () => Plotly.relayout(plot, {
        "xaxis.range": view.map.x.slice(),
        "yaxis.range": view.map.yDown ? view.map.y.slice().reverse() : view.map.y.slice(),
      });
      return view;
    }

    // The other views look where this one looks.
    let following = false;
    let isWhole = true;  // all of every picture is in sight
    async function lead(view) {
      if (following) return;
      isWhole = false;
      if (views.length < 2) return;
      following = true;
      const where = view.window();
      await Promise.all(views.filter((v) => v !== view).map((v) => v.look(where)));
      following = false;
    }

    // All of every picture, on one scale of lengths.
    async function showAll() {
      following = true;
      await Promise.all(views.map((view) => view.reset()));
      const isField = views.map((view) => Boolean(view.map.is_field));
      if (views.length > 1 && isField.every((is) => is === isField[0])) {
        const smallest = Math.min(...views.map((view) => view.window()[2]));
        await Promise.all(views.map((view) => view.look([0, 0, smallest])));
      }
      following = false;
      isWhole = true;
      for (const view of views) view.paint();
    }

    // In a window of another size all stays in sight, and fills what room there is.
    let resized = 0;
    window.addEventListener("resize", () => {
      clearTimeout(resized);
      resized = setTimeout(async () => {
        following = true;
        // Plotly follows the width by itself only as long as no height was set.
        await Promise.all(views.map((view) =>
          Plotly.relayout(view.plot, { width: view.plot.clientWidth, height: view.height() })));
        following = false;
        if (isWhole) await showAll();
      }, 200);  // after the resizing that Plotly does by itself
    });

    // The lens of all views at the place of one.
    function point(view, x, y) {
      const { map } = view;
      const middle = (range) => (range[0] + range[1]) / 2;
      const down = (m) => (m.yDown ? 1 : -1);
      const u = (x - middle(map.x)) / map.diameter;
      const v = down(map) * (y - middle(map.y)) / map.diameter;
      for (const each of views) {
        const m = each.map;
        each.at = each === view ? [x, y]
          : [middle(m.x) + u * m.diameter, middle(m.y) + down(m) * v * m.diameter];
        each.paintLens();
      }
      readout.textContent = view.describe(x, y);
    }
    function leave() {
      for (const view of views) { view.at = null; view.paintLens(); }
      readout.textContent = "";
    }

    // The frame of `view` that goes with the one shown first: the same frame, else the nearest phase
    // of the vibration, else the same share of the film.
    function partner(view, first, share) {
      const same = view.frames.find((m) => m.frame === first.frame);
      if (same) return same;
      if (first.phase !== null && view.frames.every((m) => m.phase !== null)) {
        const apart = (m) => { const d = Math.abs(m.phase - first.phase); return Math.min(d, 1 - d); };
        return view.frames.reduce((a, b) => (apart(b) < apart(a) ? b : a));
      }
      return view.frames[Math.round(share * (view.frames.length - 1))];
    }
    function showFrame() {
      const [first, ...others] = views;
      const index = Math.min(Number(slider.value), first.frames.length - 1);
      const map = first.frames[index];
      const share = first.frames.length > 1 ? index / (first.frames.length - 1) : 0;
      slider.parentElement.querySelector("output").textContent = String(map.frame);
      return Promise.all([first.show(map), ...others.map((v) => v.show(partner(v, map, share)))]);
    }

    function listRuns() {
      const framesOf = (view) => maps.filter((m) => m.run === Number(view.pick.value));
      // Also at first: a browser that loads the page again chooses what was chosen.
      if (views.flatMap(framesOf).some((m) => m.image === null)) return images.then(listRuns);
      for (const view of views) view.frames = framesOf(view);
      const all = views.flatMap((view) => view.frames);
      slider.max = String(views[0].frames.length - 1);
      // The first frame that all of them have.
      const [first, ...others] = views;
      const common = first.frames.findIndex((m) =>
        others.every((v) => v.frames.some((o) => o.frame === m.frame)));
      slider.value = String(Math.max(0, common));
      slider.parentElement.hidden = views[0].frames.length < 2;
      const has = (column) => all.some((m) => m[column]);
      select.trails.hidden = views[0].frames.length < 2 || !has("ids");
      const option = (value) => [...select.colour.options].find((o) => o.value === value);
      option("identity").hidden = !has("ids");
      option("layer").hidden = !has("layers");
      if (option(colouring).hidden) select.colour.value = colouring = "order";
      select.colour.parentElement.hidden = !has("ids") && !has("layers");
      box.querySelector(".kinds").hidden = all.every((m) => m.is_field);
      select.lens.hidden = all.every((m) => m.is_field);
      showColourBar();
      return showFrame().then(showAll);
    }
    function showColourBar() {
      const bar = box.querySelector(".colour-bar");
      const shown = views.map((view) => view.map || view.frames[0]);
      bar.hidden = marks === "none" || colouring !== "order" || shown.every((m) => !m.order);
      bar.querySelector(".order").textContent = shown[0].orderName;
    }
    const paintAll = () => views.forEach((view) => view.paint());

    for (const view of views) view.pick.addEventListener("change", listRuns);
    slider.addEventListener("input", showFrame);
    select.colour.addEventListener("change", () => { colouring = select.colour.value; showColourBar(); paintAll(); views.forEach(tell); });
    for (const button of [select.trails, select.lens]) {
      button.addEventListener("click", () => {
        button.setAttribute("aria-pressed", String(!isPressed(button)));
        paintAll();
      });
    }
    box.querySelectorAll(".kinds button").forEach((button) =>
      button.addEventListener("click", () => {
        box.querySelectorAll(".kinds button").forEach((other) =>
          other.setAttribute("aria-pressed", String(other === button)));
        marks = button.value;
        showColourBar();
        paintAll();
      }));
    const pick = (run) => {
      views[0].pick.value = String(run);
      box.scrollIntoView({ block: "nearest" });
      return listRuns();
    };
    drawGallery(maps, colours, labels, pick);

    for (const button of box.querySelectorAll(".zoom button")) {
      button.addEventListener("click", async () => {
        const view = views[0];
        if (button.value === "0") { await showAll(); return; }
        const [u, v, size] = view.window();
        await view.look([u, v, size / Number(button.value)]);
        await lead(view);
      });
    }
    for (const button of box.querySelectorAll(".place")) {
      button.addEventListener("click", async () => {
        const [m, p] = button.value.split(" ").map(Number);
        const map = maps[m];
        const view = views.find((v) => v.frames.includes(map)) || views[0];
        if (!view.frames.includes(map)) { view.pick.value = String(map.run); await listRuns(); }
        if (!view.frames.includes(map)) return;  // another run was chosen meanwhile
        slider.value = String(view === views[0] ? view.frames.indexOf(map) : slider.value);
        await (view === views[0] ? showFrame() : view.show(map));
        const [x, y] = map.places[p];
        await view.look([(x - (map.x[0] + map.x[1]) / 2) / map.diameter,
          (map.yDown ? 1 : -1) * (y - (map.y[0] + map.y[1]) / 2) / map.diameter,
          Math.min(view.frame().width, view.frame().height) / 14]);
        await lead(view);
        readout.textContent = button.title;
      });
    }

    for (const view of views) {
      const at = (event) => {
        const area = view.plot.getBoundingClientRect();
        const f = view.frame();
        const [x, y] = [event.clientX - area.left, event.clientY - area.top];
        const isInside = x >= f.left && x <= f.left + f.width && y >= f.top && y <= f.top + f.height;
        return isInside ? [f.toX(x), f.toY(y)] : null;
      };
      view.plot.addEventListener("pointermove", (event) => {
        const where = at(event);
        if (where) point(view, ...where); else leave();
      });
      view.plot.addEventListener("pointerleave", leave);
      // A click, not the end of a drag, chooses a place for space.js.
      const choose = ([x, y]) => document.dispatchEvent(new CustomEvent("map-place", {
        detail: { view: views.indexOf(view), x, y } }));
      let pressed = null;
      view.plot.addEventListener("pointerdown", (event) => { pressed = event; }, true);
      window.addEventListener("pointerup", (event) => {
        const isClick = pressed && Math.hypot(event.clientX - pressed.clientX, event.clientY - pressed.clientY) < 4;
        pressed = null;
        if (isClick && at(event)) choose(at(event));
      }, true);
      view.stage.addEventListener("blur", leave);
      // Without a pointer: arrows move the lens, + and - zoom about it, 0 shows all, Escape takes it away.
      view.stage.addEventListener("keydown", (event) => {
        const { map } = view;
        const f = view.frame();
        const step = 10 / f.scale;
        const [x, y] = view.at || [f.toX(f.left + f.width / 2), f.toY(f.top + f.height / 2)];
        const down = map.yDown ? 1 : -1;
        const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
        if (moves[event.key]) {
          const [dx, dy] = moves[event.key];
          point(view, view.at ? x + dx * step : x, view.at ? y + dy * down * step : y);
        } else if (["+", "=", "-"].includes(event.key)) {
          const [u, v, size] = view.window();
          view.look([u, v, size * (event.key === "-" ? 0.8 : 1.25)]).then(() => lead(view));
        } else if (event.key === "0") {
          showAll();
        } else if (event.key === "Enter" && view.at) {
          choose(view.at);
        } else if (event.key === "Escape") {
          leave();
        } else {
          return;
        }
        event.preventDefault();
      });
    }

    document.addEventListener("space-boxes", ({ detail }) => {
      views[detail.view].boxes = detail.boxes;
      views[detail.view].repaint();
    });

    return listRuns().then(() => {
      for (const view of views) {
        for (const event of ["plotly_relayouting", "plotly_relayout", "plotly_redraw", "plotly_afterplot"]) {
          view.plot.on(event, view.repaint);
        }
        for (const event of ["plotly_relayouting", "plotly_relayout"]) {
          view.plot.on(event, (change) => {
            if (Object.keys(change || {}).some((name) => name.includes("axis"))) lead(view);
          });
        }
        window.addEventListener("beforeprint", () => {
          const aspect = (view.map.y[1] - view.map.y[0]) / (view.map.x[1] - view.map.x[0]);
          const width = paper.width / views.length;
          const height = (width - margin.l - margin.r) * aspect + margin.t + margin.b;
          Plotly.relayout(view.plot, { width, height: Math.min(height, 800), autosize: false });
          view.paint();
        });
        window.addEventListener("afterprint", () =>
          Plotly.relayout(view.plot, { width: null, height: view.height(), autosize: true }));
      }
    });
  }

  // Part of a frame with what the settings chosen by the sliders find in it.
  function drawAlternatives(data) {
    const section = document.querySelector(".alternatives");
    if (!section || !data) return Promise.resolve();
    const canvas = section.querySelector("canvas");
    const sliders = [...section.querySelectorAll("input")];
    const [width, height] = data.size;
    const zoom = Math.max(1, Math.round(1000 / Math.max(width, height)));
    canvas.width = width * zoom;
    canvas.height = height * zoom;
    const picture = new Image();
    const show = () => {
      const chosen = sliders.map((slider) => Number(slider.value));
      const one = data.tried[chosen.reduce((at, value, a) => at * data.axes[a].length + value, 0)];
      sliders.forEach((slider, a) => {
        const text = data.axes[a][chosen[a]];
        slider.parentElement.querySelector("output").textContent = text;
        slider.setAttribute("aria-valuetext", text);
      });
      section.querySelector(".found").textContent = one.words;
      section.querySelector("pre").textContent = one.settings;
      section.querySelector(".copy").textContent = "Copy";
      const context = canvas.getContext("2d");
      context.imageSmoothingEnabled = false;
      context.drawImage(picture, 0, 0, canvas.width, canvas.height);
      context.beginPath();
      const r = 0.5 * one.diameter * zoom;
      for (let i = 0; i < one.at.length; i += 2) {
        // Pixel (0, 0) has its centre at 0.
        const [x, y] = [(one.at[i] / 10 + 0.5) * zoom, (one.at[i + 1] / 10 + 0.5) * zoom];
        context.moveTo(x + r, y);
        context.arc(x, y, r, 0, 2 * Math.PI);
      }
      for (const [colour, line] of [["rgba(255,255,255,0.8)", 5], ["#c2410c", 2.5]]) {
        context.strokeStyle = colour;
        context.lineWidth = line;
        context.stroke();
      }
    };
    for (const slider of sliders) slider.addEventListener("input", show);
    return new Promise((done) => {
      picture.onload = () => { show(); done(); };
      picture.onerror = () => { problem("the picture of the alternatives cannot be decoded"); done(); };
      picture.src = data.image;
    });
  }

  // Where the browser gives no clipboard the text is selected all the same.
  function addCopying() {
    for (const button of document.querySelectorAll(".copy")) {
      button.addEventListener("click", () => {
        const range = document.createRange();
        range.selectNodeContents(button.parentElement.querySelector("pre"));
        const selection = window.getSelection();
        selection.removeAllRanges();
        selection.addRange(range);
        button.textContent = document.execCommand("copy") ? "Copied" : "Selected";
      });
    }
  }

  async function drawPage() {
    addCopying();
    if (document.querySelector(".space") && !root.dataset.space) problem("the view from the side did not start");
    try {
      const data = JSON.parse(document.getElementById("report-data").textContent);
      const tried = drawAlternatives(data.alternatives);
      const images = followingImages(data.maps);
      await drawFigures(data.figures, drawMaps(data.maps, data.colours, data.runs, images), () => {
        root.dataset.opened = String(Math.round(performance.now()));
      });
      await Promise.all([tried, images]);
      root.dataset.milliseconds = String(Math.round(performance.now()));
      root.dataset.ready = String(document.querySelectorAll(".js-plotly-plot").length);
      const next = () => { const draw = waitingMaps.shift(); if (draw) { draw(); setTimeout(next, 0); } };
      next();
    } catch (error) {
      problem(String(error && error.stack || error));
    }
  }
  drawPage();
})();
