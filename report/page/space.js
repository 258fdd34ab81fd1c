"use strict";
// The layer from the side, and a patch of it in space: drawn on canvases for the map that each view
// of page.js shows. The two scripts speak by events of the document:
//   map-shown   { view, map, caption, colours() }   a view shows a map, or colours it otherwise
//   map-place   { view, x, y }                      a place of its map was chosen
//   space-boxes { view, boxes }                     what of the map is shown here: [x, y, x, y], …
// Lengths are diameters a. A place is (u, v) from the middle of the picture, v down the screen, so that
// it is the same in maps of other units.
(() => {
  const section = document.querySelector(".space");
  if (!section) return;
  const stripLength = 40;  // at most
  const stripDepth = 2;
  const patchSide = 12;
  const doubtful = 20;  // error of a height that is as good as unknown [a/100]
  const first = { turn: 30, tilt: 35 };  // degrees: about the vertical; of the eye above the plate
  const font = "12px system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif";
  const ink = "#1a1a1a";

  const figures = (kind) => [...section.querySelectorAll(kind)];
  const patches = figures(".patch-view");
  const views = figures(".side-view").map((side, v) => ({ side, patch: patches[v], shown: null }));
  const sliders = { u: section.querySelector(".along"), v: section.querySelector(".across") };
  const place = { u: 0, v: 0 };
  const angle = { ...first };

  // ---- what is drawn ------------------------------------------------------------------------

  const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const middle = (range) => (range[0] + range[1]) / 2;
  const clamp = (value, low, high) => Math.min(Math.max(value, low), Math.max(low, high));
  const down = (map) => (map.yDown ? 1 : -1);

  // Half of the picture.
  const reach = (map) => ({
    u: (map.x[1] - map.x[0]) / 2 / map.diameter, v: (map.y[1] - map.y[0]) / 2 / map.diameter,
  });

  // Places and heights of all particles whose height is known.
  function spheresOf(map) {
    if (map.spheres) return map.spheres;
    const steps = new DataView(bytes(map.z).buffer);
    const errors = bytes(map.zErrors);
    const step = (map.zRange[1] - map.zRange[0]) / 65534;
    map.spheres = [];
    for (let i = 0; i < map.px.length; i++) {
      const height = steps.getUint16(2 * i, true);
      if (height === 65535) continue;
      map.spheres.push({
        i,
        u: (map.px[i] - middle(map.x)) / map.diameter,
        v: down(map) * (map.py[i] - middle(map.y)) / map.diameter,
        z: (map.zRange[0] + step * height) / map.diameter,
        isDoubtful: errors.length > 0 && errors[i] > doubtful,
      });
    }
    return map.spheres;
  }

  // The part of a map about the place that is `length` by `depth`, or all that there is, within it.
  function boxAbout(map, length, depth) {
    const all = reach(map);
    const part = (at, size, most) => {
      const half = Math.min(size / 2, most);
      const centre = clamp(at, half - most, most - half);
      return [centre - half, centre + half];
    };
    return { u: part(place.u, length, all.u), v: part(place.v, depth, all.v) };
  }

  const within = (value, [low, high]) => value >= low && value <= high;
  const membersOf = (map, box) =>
    spheresOf(map).filter((s) => within(s.u, box.u) && within(s.v, box.v));

  // Corners of a box, in the units of the map.
  function cornersOf(map, box) {
    const x = box.u.map((u) => middle(map.x) + u * map.diameter);
    const y = box.v.map((v) => middle(map.y) + down(map) * v * map.diameter);
    return [x[0], y[0], x[1], y[1]];
  }

  // ---- canvas -------------------------------------------------------------------------------

  // A clean canvas of this many CSS pixels, which shrinks with a narrower page.
  function prepare(canvas, width, height) {
    const ratio = window.devicePixelRatio || 1;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    canvas.style.width = width + "px";
    const context = canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.font = font;
    context.lineWidth = 1;
    return context;
  }

  function line(context, colour, x0, y0, x1, y1) {
    context.strokeStyle = colour;
    context.beginPath();
    context.moveTo(x0, y0);
    context.lineTo(x1, y1);
    context.stroke();
  }

  function write(context, text, x, y, align = "center") {
    context.fillStyle = ink;
    context.textAlign = align;
    context.textBaseline = "middle";
    context.fillText(text, x, y);
  }

  function addCircle(context, x, y, r) {
    context.beginPath();
    context.arc(x, y, r, 0, 2 * Math.PI);
  }

  // A disc with a thin rim, mixed with this part of white.
  function drawDisc(context, x, y, r, colour, white) {
    addCircle(context, x, y, r);
    for (const fill of [colour, `rgba(255,255,255,${white})`]) {
      context.fillStyle = fill;
      context.fill();
    }
    context.strokeStyle = "rgba(0,0,0,0.6)";
    context.stroke();
  }

  // A sphere whose height is doubtful: nearly hollow, and dashed.
  function drawRing(context, x, y, r, colour) {
    addCircle(context, x, y, r);
    for (const fill of [colour, "rgba(255,255,255,0.8)"]) {
      context.fillStyle = fill;
      context.fill();
    }
    context.lineWidth = 1.4;
    context.strokeStyle = ink;
    context.setLineDash([4, 3]);
    context.stroke();
    context.setLineDash([]);
    context.lineWidth = 1;
  }

  // Light from above on the left, about the origin.
  function shadeOf(context, r) {
    const shade = context.createRadialGradient(-0.35 * r, -0.4 * r, 0.05 * r, -0.1 * r, -0.1 * r, 1.1 * r);
    shade.addColorStop(0, "rgba(255,255,255,0.75)");
    shade.addColorStop(0.4, "rgba(255,255,255,0.05)");
    shade.addColorStop(1, "rgba(0,0,0,0.6)");
    return shade;
  }

  function drawSphere(context, x, y, r, colour, shade) {
    context.translate(x, y);
    addCircle(context, 0, 0, r);
    for (const fill of [colour, shade]) {
      context.fillStyle = fill;
      context.fill();
    }
    context.translate(-x, -y);
  }

  // ---- from the side ------------------------------------------------------------------------

  const margin = { l: 42, r: 10, t: 8, b: 34 };

  // What the axis of heights spans: all spheres of the map and the plates, whichever strip is shown.
  function heightsOf(map) {
    const [low, high] = map.zRange.map((z) => z / map.diameter);
    return [Math.min(0, low - 0.5) - 0.1, Math.max(map.height / map.diameter, high + 0.5) + 0.1];
  }

  // Where the strip lies on the canvas, on one scale along and up. A narrow page shows a shorter one.
  function sideFrame(map, room) {
    const least = 12;  // CSS pixels a diameter
    const most = 60;
    const wide = room - margin.l - margin.r;
    const box = boxAbout(map, Math.min(stripLength, wide / least - 1), stripDepth);
    const length = box.u[1] - box.u[0] + 1;  // spheres reach half a diameter beyond
    const scale = Math.min(most, wide / length);
    const z = heightsOf(map);
    const bottom = margin.t + scale * (z[1] - z[0]);
    return {
      box, z, scale, bottom,
      right: margin.l + scale * length,
      x: (u) => margin.l + scale * (u - box.u[0] + 0.5),
      y: (height) => bottom - scale * (height - z[0]),
    };
  }

  function drawSideAxes(context, map, f) {
    const origin = middle(map.x) / map.diameter;  // the axis has the x of the map
    const [low, high] = f.box.u.map((u) => u + origin);
    const step = [1, 2, 5, 10].find((s) => s * f.scale >= 55) || 10;
    for (let x = Math.ceil(low / step) * step; x <= high + 1e-6; x += step) {
      line(context, "#888", f.x(x - origin), f.bottom, f.x(x - origin), f.bottom + 4);
      write(context, String(x), f.x(x - origin), f.bottom + 12);
    }
    for (let z = Math.ceil(f.z[0]); z <= f.z[1]; z++) {
      line(context, "#888", margin.l - 4, f.y(z), margin.l, f.y(z));
      write(context, String(z), margin.l - 7, f.y(z), "right");
    }
    context.strokeStyle = "#888";
    context.strokeRect(margin.l, margin.t, f.right - margin.l, f.bottom - margin.t);
    write(context, "x / a", (margin.l + f.right) / 2, f.bottom + 26);
    context.save();
    context.translate(10, (margin.t + f.bottom) / 2);
    context.rotate(-Math.PI / 2);
    write(context, "z / a", 0, 0);
    context.restore();
  }

  function drawPlates(context, map, f) {
    const faces = map.height > 0 ? [0, map.height / map.diameter] : [0];
    for (const z of faces) line(context, ink, margin.l, f.y(z), f.right, f.y(z));
  }

  // From back to front, which is down the picture; what is behind is paler.
  function drawSide(view) {
    const { map, colours } = view.shown;
    const f = sideFrame(map, view.side.clientWidth);
    const canvas = view.side.querySelector("canvas");
    const context = prepare(canvas, Math.ceil(f.right + margin.r), Math.ceil(f.bottom + margin.b));
    const members = membersOf(map, f.box).sort((a, b) => a.v - b.v);
    drawPlates(context, map, f);
    const palest = 0.5;
    for (const s of members) {
      const behind = (f.box.v[1] - s.v) / (f.box.v[1] - f.box.v[0]);
      const where = [f.x(s.u), f.y(s.z), 0.5 * f.scale, colours[s.i]];
      if (s.isDoubtful) drawRing(context, ...where);
      else drawDisc(context, ...where, palest * behind);
    }
    drawSideAxes(context, map, f);
    view.side.querySelector(".state").textContent = countOf(members);
    return cornersOf(map, f.box);
  }

  function countOf(members) {
    const unsure = members.filter((s) => s.isDoubtful).length;
    return `${members.length} spheres` + (unsure ? `, the height of ${unsure} uncertain (dashed)` : "");
  }

  // ---- in space -----------------------------------------------------------------------------

  // Without perspective: right and up on the screen, and towards the eye.
  function projection(box) {
    const [turn, tilt] = [angle.turn, angle.tilt].map((degrees) => degrees * Math.PI / 180);
    const centre = { u: middle(box.u), v: middle(box.v) };
    return (u, v, z) => {
      const [east, north] = [u - centre.u, centre.v - v];
      const right = east * Math.cos(turn) - north * Math.sin(turn);
      const away = east * Math.sin(turn) + north * Math.cos(turn);
      return {
        right,
        up: away * Math.sin(tilt) + z * Math.cos(tilt),
        near: z * Math.sin(tilt) - away * Math.cos(tilt),
      };
    };
  }

  // The plate below the patch, with the names of its edges.
  function drawGround(context, box, at) {
    const corners = [[0, 1], [1, 1], [1, 0], [0, 0]].map(([a, b]) => at(box.u[a], box.v[b], 0));
    context.beginPath();
    for (const { x, y } of corners) context.lineTo(x, y);
    context.closePath();
    context.fillStyle = "#f1f1f1";
    context.fill();
    context.strokeStyle = "#888";
    context.stroke();
    const beyond = 0.9;
    const x = at(middle(box.u), box.v[1] + beyond, 0);
    const y = at(box.u[0] - beyond, middle(box.v), 0);
    write(context, "x", x.x, x.y);
    write(context, "y", y.x, y.y);
  }

  // Where the patch lies on the canvas: as large as fits, whichever way it is turned.
  function patchFrame(map, width, height) {
    const box = boxAbout(map, patchSide, patchSide);
    const project = projection(box);
    const heights = heightsOf(map);
    const tilt = angle.tilt * Math.PI / 180;
    const across = Math.SQRT2 * (patchSide + 1);
    const tall = across * Math.sin(tilt) + (heights[1] - heights[0] + 1) * Math.cos(tilt);
    const scale = Math.min(width / across, height / tall);
    const level = middle(heights) * Math.cos(tilt);
    return {
      box, scale,
      at: (u, v, z) => {
        const p = project(u, v, z);
        return { x: width / 2 + scale * p.right, y: height / 2 - scale * (p.up - level), near: p.near };
      },
    };
  }

  // The farthest first, so that nearer ones cover them: exact for spheres of one size.
  function drawPatch(view) {
    const { map, colours } = view.shown;
    const width = Math.min(620, view.patch.clientWidth);
    const height = Math.min(400, Math.round(0.75 * width));
    const context = prepare(view.patch.querySelector("canvas"), width, height);
    const { box, scale, at } = patchFrame(map, width, height);
    drawGround(context, box, at);
    const shade = shadeOf(context, 0.5 * scale);
    const members = membersOf(map, box);
    const drawn = members.map((s) => ({ s, ...at(s.u, s.v, s.z) })).sort((a, b) => a.near - b.near);
    for (const { s, x, y } of drawn) {
      if (s.isDoubtful) drawRing(context, x, y, 0.5 * scale, colours[s.i]);
      else drawSphere(context, x, y, 0.5 * scale, colours[s.i], shade);
    }
    view.patch.querySelector(".state").textContent =
      `Turned by ${angle.turn}°, seen from ${angle.tilt}° above the plate; ${countOf(members)}`;
    return cornersOf(map, box);
  }

  // ---- what moves it ------------------------------------------------------------------------

  let waiting = 0;
  const redraw = () => { waiting = waiting || requestAnimationFrame(drawAll); };

  function drawAll() {
    waiting = 0;
    let isAnyDoubtful = false;
    views.forEach((view, v) => {
      if (!view.shown) return;
      const boxes = [drawSide(view), drawPatch(view)];
      isAnyDoubtful = isAnyDoubtful || spheresOf(view.shown.map).some((s) => s.isDoubtful);
      const said = String(boxes);
      if (said === view.said) return;
      view.said = said;
      document.dispatchEvent(new CustomEvent("space-boxes", { detail: { view: v, boxes } }));
    });
    section.querySelector(".doubtful").hidden = !isAnyDoubtful;
  }

  // Sliders over the first picture that is drawn; they say how far from its middle it is.
  function setSliders() {
    const view = views.find((each) => each.shown);
    if (!view) return;
    const most = reach(view.shown.map);
    const words = { u: ["left", "right"], v: ["above", "below"] };
    for (const axis of ["u", "v"]) {
      sliders[axis].min = -Math.floor(2 * most[axis]) / 2;
      sliders[axis].max = Math.floor(2 * most[axis]) / 2;
      sliders[axis].value = String(place[axis]);
      const far = Math.abs(place[axis]).toFixed(1);
      const side = words[axis][place[axis] < 0 ? 0 : 1];
      const text = far === "0.0" ? "through the middle" : `${far} a ${side}${axis === "u" ? " of" : ""} the middle`;
      sliders[axis].parentElement.querySelector("output").textContent = text;
      sliders[axis].setAttribute("aria-valuetext", text);
    }
  }

  function moveTo(to) {
    Object.assign(place, to);
    setSliders();
    redraw();
  }

  function turnTo(turn, tilt) {
    angle.turn = Math.round(((turn % 360) + 360) % 360);
    angle.tilt = Math.round(clamp(tilt, 0, 90));
    redraw();
  }

  function addDragging(canvas) {
    const speed = 0.5;  // degrees a CSS pixel
    let from = null;
    canvas.addEventListener("pointerdown", (event) => {
      from = { x: event.clientX, y: event.clientY, ...angle };
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!from) return;
      turnTo(from.turn + speed * (event.clientX - from.x), from.tilt + speed * (event.clientY - from.y));
    });
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => { from = null; });
  }

  function addKeys(canvas) {
    const moves = { ArrowLeft: [-5, 0], ArrowRight: [5, 0], ArrowUp: [0, -5], ArrowDown: [0, 5] };
    canvas.addEventListener("keydown", (event) => {
      const move = moves[event.key];
      if (move) turnTo(angle.turn + move[0], angle.tilt + move[1]);
      else if (event.key === "0") turnTo(first.turn, first.tilt);
      else return;
      event.preventDefault();
    });
  }

  for (const axis of ["u", "v"]) {
    sliders[axis].addEventListener("input", () => moveTo({ [axis]: Number(sliders[axis].value) }));
  }
  for (const view of views) {
    const canvas = view.patch.querySelector("canvas");
    addDragging(canvas);
    addKeys(canvas);
  }
  window.addEventListener("resize", redraw);
  document.addEventListener("map-shown", ({ detail }) => {
    const view = views[detail.view];
    const isKnown = detail.map.z !== undefined;
    view.shown = isKnown ? { map: detail.map, colours: detail.colours() } : null;
    view.said = "";
    for (const [figure, part] of [[view.side, "Strip"], [view.patch, "Patch"]]) {
      figure.hidden = !isKnown;
      figure.querySelector(".caption").textContent = `${part} of ${detail.caption}`;
    }
    if (!isKnown) document.dispatchEvent(new CustomEvent("space-boxes", { detail: { view: detail.view, boxes: [] } }));
    section.hidden = views.every((each) => !each.shown);
    setSliders();
    redraw();
  });
  document.addEventListener("map-place", ({ detail }) => {
    const { map } = views[detail.view].shown || {};
    if (!map) return;
    moveTo({
      u: (detail.x - middle(map.x)) / map.diameter,
      v: down(map) * (detail.y - middle(map.y)) / map.diameter,
    });
  });
  document.documentElement.dataset.space = "ready";  // page.js says so where it is missing
})();
