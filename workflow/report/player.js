// Plays the slides and the equilibrium path under rising Kh within the report. Films stand in scripts of the kind
// application/json; where this script does not run, the players stay hidden and the still pictures serve.
"use strict";
(() => {
  const INK = "#26323a", BOUNDARY = "#4a4f55", NOW = "#0b3c6f", CRITICAL = "#b3202c", GRID = "#dddddd";

  async function unpacked(film) {
    const bytes = Uint8Array.from(atob(film.packed), (letter) => letter.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    const numbers = new Int32Array(await new Response(stream).arrayBuffer());
    let at = 0;
    return (count) => numbers.subarray(at, (at += count));
  }

  // A canvas as sharp as the screen, with the section's metres fitted into its width; `room` is a margin in pixels.
  function view(canvas, size, room) {
    const width = canvas.parentElement.clientWidth || 1000, scale = (width - 2 * room) / size[0];
    const height = Math.round(size[1] * scale + 2 * room), sharp = window.devicePixelRatio || 1;
    canvas.width = Math.round(width * sharp); canvas.height = Math.round(height * sharp);
    canvas.style.height = height + "px";
    const pen = canvas.getContext("2d");
    pen.setTransform(sharp, 0, 0, sharp, 0, 0);
    pen.clearRect(0, 0, width, height);
    return { pen, width, height, x: (x) => room + x * scale, y: (y) => height - room - y * scale, scale };
  }

  // Curves over a common axis, and a line where the film stands.
  function chart(canvas, lines, across, here, marks) {
    const width = canvas.parentElement.clientWidth || 1000, height = 150, sharp = window.devicePixelRatio || 1;
    canvas.width = width * sharp; canvas.height = height * sharp; canvas.style.height = height + "px";
    const pen = canvas.getContext("2d");
    pen.setTransform(sharp, 0, 0, sharp, 0, 0);
    pen.clearRect(0, 0, width, height);
    const all = lines.flatMap((line) => line.y).concat(marks);
    const low = Math.min(0, ...all), high = Math.max(1e-9, ...all), last = Math.max(1e-12, ...lines.flatMap((line) => line.x));
    const px = (x) => 54 + (width - 70) * x / last, py = (y) => 12 + (height - 44) * (high - y) / (high - low);
    pen.font = "11px 'DejaVu Sans', sans-serif"; pen.fillStyle = INK; pen.strokeStyle = GRID; pen.lineWidth = 1;
    for (const y of [low, (low + high) / 2, high]) {
      pen.beginPath(); pen.moveTo(54, py(y)); pen.lineTo(width - 16, py(y)); pen.stroke();
      pen.fillText(y.toPrecision(2), 8, py(y) + 4);
    }
    pen.fillText("0", 54, height - 18); pen.fillText(last.toPrecision(3), width - 46, height - 18);
    pen.fillText(across, width / 2 - 60, height - 18);
    pen.strokeStyle = CRITICAL;
    for (const y of marks) { pen.beginPath(); pen.moveTo(54, py(y)); pen.lineTo(width - 16, py(y)); pen.stroke(); }
    lines.forEach((line, number) => {
      pen.strokeStyle = line.colour; pen.setLineDash(number ? [6, 3] : []); pen.lineWidth = 1.6; pen.beginPath();
      line.x.forEach((x, i) => (i ? pen.lineTo(px(x), py(line.y[i])) : pen.moveTo(px(x), py(line.y[i]))));
      pen.stroke(); pen.setLineDash([]);
      pen.fillStyle = line.colour; pen.fillText((number ? "- - " : "— ") + line.name, 60 + 190 * number, height - 4);
    });
    pen.strokeStyle = INK; pen.beginPath(); pen.moveTo(px(here), 8); pen.lineTo(px(here), height - 32); pen.stroke();
  }

  async function slideScene(film) {
    const take = await unpacked(film), n = film.discs, count = film.times.length;
    const radius = take(n), stratum = take(n), start = take(2 * n), places = [start];
    for (let k = 1; k < count; k++) {
      const moved = take(2 * n), next = new Int32Array(places[k - 1]);
      for (let i = 0; i < 2 * n; i++) next[i] += moved[i];
      places.push(next);
    }
    const q = film.quantum;
    const nearest = (time) => film.history.reduce((a, b) => (Math.abs(b[0] - time) < Math.abs(a[0] - time) ? b : a));
    const history = [
      { name: "largest slide (m)", x: film.history.map((row) => row[0]), y: film.history.map((row) => row[1]), colour: NOW },
      { name: "settlement uphill (m)", x: film.history.map((row) => row[0]), y: film.history.map((row) => row[2]), colour: CRITICAL },
    ];
    return {
      count, choices: ["displacement", "layers"],
      says(k) {
        const time = `t = ${film.times[k].toFixed(1)} s`;
        if (!film.history.length) return time;
        const [, slide, settled] = nearest(film.times[k]);
        return `${time}: largest slide ${slide.toFixed(2)} m, settlement uphill ${settled.toFixed(2)} m`;
      },
      draw(canvas, below, k, choice) {
        const { pen, x, y, scale } = view(canvas, film.size, 4), now = places[k], line = new Map();
        for (let i = 0; i < n; i++) {
          const far = q * Math.hypot(now[2 * i] - start[2 * i], now[2 * i + 1] - start[2 * i + 1]);
          const shade = Math.min(film.shades.length - 1, Math.floor(film.shades.length * far / film.far));
          const colour = stratum[i] < 0 ? BOUNDARY : choice ? film.soils[stratum[i]] : film.shades[shade];
          (line.get(colour) || line.set(colour, []).get(colour)).push(i);
        }
        for (const [colour, discs] of line) {
          pen.fillStyle = colour; pen.beginPath();
          for (const i of discs) {
            const a = x(q * now[2 * i]), b = y(q * now[2 * i + 1]), r = Math.max(0.6, q * radius[i] * scale);
            pen.moveTo(a + r, b); pen.arc(a, b, r, 0, 7);
          }
          pen.fill();
        }
        for (const [where, colour, dash] of [[start, INK, [5, 3]], [now, NOW, []]]) {
          pen.strokeStyle = colour; pen.setLineDash(dash); pen.lineWidth = 1.6; pen.beginPath();
          film.surface.forEach((i, place) => {
            const r = q * radius[i], a = x(q * where[2 * i]), b = y(q * where[2 * i + 1] + r);
            place ? pen.lineTo(a, b) : pen.moveTo(a, b);
          });
          pen.stroke();
        }
        pen.setLineDash([]);
        if (film.history.length) chart(below, history, "time since the onset (s)", film.times[k], []);
      },
    };
  }

  async function pathScene(film) {
    const take = await unpacked(film), n = film.nodes, m = film.cells;
    const points = take(2 * n), cells = take(4 * m);
    const states = film.states.map((state) => ({ ...state, u: take(2 * n), mobilised: take(m) }));
    const still = { step: -1, u: new Int32Array(2 * n), mobilised: null, label: "" };
    const length = (step) => (step < 0 ? 0 : film.displacement[step]);
    const curve = [{ name: "Kh", x: [0, ...film.displacement], y: [0, ...film.kh], colour: NOW }];
    const between = (k) => {
      const before = [still, ...states].filter((state) => state.step <= k).pop();
      const after = states.find((state) => state.step > k) || before;
      const span = length(after.step) - length(before.step);
      return { before, after, share: span > 0 ? (length(k) - length(before.step)) / span : 0 };
    };
    return {
      count: film.kh.length, choices: [],
      says(k) {
        const { before } = between(k), kept = before.step === k;
        return `Kh = ${film.kh[k].toFixed(3)}, mean displacement ${(100 * film.displacement[k]).toPrecision(3)} cm; ` +
          (kept ? `fields kept here (${before.label})` : "displacement drawn in proportion between the states that were kept") +
          (before.mobilised && !kept ? `, strength as at ${before.label}` : "");
      },
      draw(canvas, below, k) {
        const { pen, x, y } = view(canvas, film.size, 24), { before, after, share } = between(k);
        const at = (node) => {
          const by = film.stretch * film.fine, u = (c) => before.u[2 * node + c] * (1 - share) + after.u[2 * node + c] * share;
          return [x(film.quantum * points[2 * node] + by * u(0)), y(film.quantum * points[2 * node + 1] + by * u(1))];
        };
        for (let c = 0; c < m; c++) {
          let shade = "#efece4";
          if (before.mobilised) {
            const share = before.mobilised[c] / 1000;
            const place = film.bounds.slice(1, -1).filter((bound) => share >= bound).length;
            shade = film.shades[place];
          }
          pen.beginPath();
          for (let corner = 0; corner < 4; corner++) {
            const [a, b] = at(cells[4 * c + corner]);
            corner ? pen.lineTo(a, b) : pen.moveTo(a, b);
          }
          pen.closePath(); pen.fillStyle = shade; pen.fill();
          pen.strokeStyle = "rgba(70,65,55,.35)"; pen.lineWidth = 0.5; pen.stroke();
        }
        chart(below, curve, "mean displacement (m)", film.displacement[k], [film.kc]);
      },
    };
  }

  function made(kind, words, parent) {
    const node = document.createElement(kind);
    if (words) node.textContent = words;
    parent.appendChild(node);
    return node;
  }

  function player(figure, films, sceneOf, everyMs) {
    const stage = figure.querySelector(".stage"), canvas = made("canvas", "", stage), below = made("canvas", "", stage);
    const bar = figure.querySelector(".controls"), says = figure.querySelector(".says");
    const button = (words, label, act) => {
      const one = made("button", words, bar);
      one.type = "button"; one.setAttribute("aria-label", label); one.addEventListener("click", act);
      return one;
    };
    let scene = null, frame = 0, timer = null, choice = 0;
    const show = (k) => {
      frame = Math.max(0, Math.min(scene.count - 1, k));
      slider.value = frame;
      scene.draw(canvas, below, frame, choice);
      says.textContent = scene.says(frame);
      figure.dataset.frame = frame;
    };
    const pause = () => { clearInterval(timer); timer = null; play.textContent = "▶"; figure.dataset.playing = "no"; };
    const start = () => {
      if (frame === scene.count - 1) show(0);
      play.textContent = "❚❚"; figure.dataset.playing = "yes";
      timer = setInterval(() => (frame < scene.count - 1 ? show(frame + 1) : pause()), everyMs);
    };
    const step = (by) => { pause(); show(frame + by); };
    button("❚◀", "one step back", () => step(-1));
    const play = button("▶", "play or pause", () => (timer ? pause() : start()));
    button("▶❚", "one step on", () => step(1));
    const slider = made("input", "", bar);
    slider.type = "range"; slider.min = 0; slider.setAttribute("aria-label", "where the film stands");
    slider.addEventListener("input", () => { pause(); show(Number(slider.value)); });
    const which = made("select", "", bar), colours = made("select", "", bar);
    which.setAttribute("aria-label", "which film"); colours.setAttribute("aria-label", "colours");
    films.forEach((film) => made("option", film.title, which));
    which.hidden = films.length < 2;
    const open = async () => {
      scene = await sceneOf(films[which.selectedIndex]);
      slider.max = scene.count - 1;
      colours.replaceChildren();
      scene.choices.forEach((name) => made("option", name, colours));
      colours.hidden = !scene.choices.length; colours.selectedIndex = scene.choices.length ? choice : -1;
      figure.dataset.frames = scene.count;
      pause(); show(scene.count - 1);
    };
    which.addEventListener("change", open);
    colours.addEventListener("change", () => { choice = colours.selectedIndex; show(frame); });
    window.addEventListener("resize", () => scene && show(frame));
    figure.hidden = false;
    open();
  }

  const films = (kind) => [...document.querySelectorAll(`script[data-film="${kind}"]`)].map((one) => JSON.parse(one.textContent));
  if (!("DecompressionStream" in window)) return;
  for (const [kind, sceneOf, everyMs] of [["slides", slideScene, 120], ["path", pathScene, 250]]) {
    const figure = document.getElementById("play-" + kind), found = films(kind);
    if (figure && found.length) player(figure, found, sceneOf, everyMs);
  }
})();
