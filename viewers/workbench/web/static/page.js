/* What the page's template cannot say by itself: pictures, curves, icons, files that come and go. */
(function () {
  "use strict";
  const { h } = Vue;
  const here = window.location.pathname.replace(/[^/]*$/, "");
  const trigger = (name, given) => window.trame.trigger(name, given || []);
  const say = (words) => trigger("say", [words, true]);

  /* Files. The server says itself why it refuses one; only what never reached it is said here. */

  async function upload(file) {
    if (!file) return;
    window.trame.state.set("notice_kind", "words");
    window.trame.state.set("notice", `Reading ${file.name} …`);
    try {
      await fetch(`${here}upload?name=${encodeURIComponent(file.name)}`, { method: "POST", body: file });
    } catch (problem) {
      say(`${file.name} could not be sent: it is too large, or the connection to kirisurf was lost.`);
    }
  }

  async function download(name) {
    document.querySelectorAll("details[open]").forEach((menu) => menu.removeAttribute("open"));
    window.trame.state.set("busy", name);
    try {
      const answer = await fetch(`${here}download/${name}`);
      if (!answer.ok) return;
      const called = /filename\*=UTF-8''(.*)$/.exec(answer.headers.get("Content-Disposition") || "");
      const link = document.createElement("a");
      link.href = URL.createObjectURL(await answer.blob());
      link.download = called ? decodeURIComponent(called[1]) : name;
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 60000);
    } catch (problem) {
      say("The file could not be fetched: the connection to kirisurf was lost.");
    } finally {
      window.trame.state.set("busy", "");
    }
  }

  /* The last of many values of a slider, one request at a time. */
  let wanted = null;
  let asking = false;
  async function deploy(share) {
    wanted = share;
    if (asking) return;
    asking = true;
    while (wanted !== null) {
      const next = wanted;
      wanted = null;
      await trigger("deploy", [next]);
    }
    asking = false;
  }

  window.addEventListener("dragover", (event) => {
    event.preventDefault();
    document.body.classList.add("dropping");
  });
  window.addEventListener("dragleave", (event) => {
    if (!event.relatedTarget) document.body.classList.remove("dropping");
  });
  window.addEventListener("drop", (event) => {
    event.preventDefault();
    document.body.classList.remove("dropping");
    upload(event.dataTransfer.files[0]);
  });
  window.addEventListener("click", (event) => {
    document.querySelectorAll("details[open]").forEach((menu) => {
      if (!menu.contains(event.target)) menu.removeAttribute("open");
    });
  });
  window.addEventListener("keydown", (event) => {
    const typing = /^(INPUT|TEXTAREA)$/.test(event.target.tagName) && !/checkbox|range|file/.test(event.target.type);
    const control = event.ctrlKey || event.metaKey;
    if (control && event.key.toLowerCase() === "z" && !typing) trigger(event.shiftKey ? "redo" : "undo");
    else if (event.key === "F5" && !control && !event.shiftKey) trigger("fit");
    else if (event.key === "Escape") trigger("stop");
    else return;
    event.preventDefault();
  });

  /* The two pictures: images come in, what a hand does goes out. */

  const Pictures = {
    props: { placing: Boolean, notes: Array, ready: Number },
    emits: ["picked"],
    data: () => ({ scales: [], isDrawn: false }),
    mounted() {
      this.pressed = null;
      this.connect();
      this.observer = new ResizeObserver(() => this.measure());
      this.observer.observe(this.$refs.canvas.parentElement);
      window.kirisurfReset = () => this.send({ kind: "reset" });
    },
    beforeUnmount() {
      this.observer.disconnect();
      this.socket.onclose = null;
      this.socket.close();
    },
    methods: {
      connect() {
        this.socket = new WebSocket(`ws://${window.location.host}${here}pictures`);
        this.socket.binaryType = "blob";
        this.socket.onopen = () => this.measure();
        this.socket.onmessage = (event) => this.take(event.data);
        this.socket.onclose = () => setTimeout(() => this.connect(), 1000);
      },
      send(message) {
        if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
      },
      measure() {
        const box = this.$refs.canvas.parentElement;
        const ratio = window.devicePixelRatio || 1;
        if (box.clientWidth) this.send({ kind: "size", width: box.clientWidth, height: box.clientHeight, ratio });
      },
      async take(data) {
        if (typeof data === "string") {
          const message = JSON.parse(data);
          if (message.scales) this.scales = message.scales;
          if (message.picked) this.$emit("picked");
          return;
        }
        const image = await createImageBitmap(data);
        const canvas = this.$refs.canvas;
        if (canvas) {
          if (canvas.width !== image.width || canvas.height !== image.height) {
            canvas.width = image.width;
            canvas.height = image.height;
          }
          canvas.getContext("2d").drawImage(image, 0, 0);
          this.isDrawn = true;
          canvas.dataset.images = Number(canvas.dataset.images || 0) + 1;
        }
        this.send({ kind: "shown" });
      },
      at(event) {
        const box = this.$refs.canvas.getBoundingClientRect();
        return { x: event.clientX - box.left, y: event.clientY - box.top };
      },
      press(event) {
        event.preventDefault();
        this.$refs.canvas.focus();
        this.$refs.canvas.setPointerCapture(event.pointerId);
        const at = this.at(event);
        const isRight = at.x > 0.5 * this.$refs.canvas.clientWidth;
        const isShift = event.button !== 0 || event.ctrlKey || event.metaKey;
        const places = (this.placing || event.shiftKey) && isRight && !isShift;
        this.pressed = { first: at, last: at, moved: false, kind: places ? "place" : isShift ? "shift" : "turn" };
      },
      move(event) {
        const pressed = this.pressed;
        if (!pressed) return;
        const at = this.at(event);
        if (!pressed.moved && Math.hypot(at.x - pressed.first.x, at.y - pressed.first.y) <= 4) return;
        pressed.moved = true;
        this.hand(pressed, at, false);
        pressed.last = at;
      },
      release(event) {
        const pressed = this.pressed;
        this.pressed = null;
        if (!pressed) return;
        const at = this.at(event);
        if (pressed.moved) this.hand(pressed, at, true);
        else if (pressed.kind !== "shift") this.send({ kind: "click", ...at });
      },
      hand(pressed, at, ended) {
        if (pressed.kind === "place") {
          this.send({ kind: "place", ...at, x0: pressed.first.x, y0: pressed.first.y, ended });
        } else {
          this.send({ kind: pressed.kind, ...pressed.first, dx: at.x - pressed.last.x, dy: at.y - pressed.last.y });
        }
      },
      key(event) {
        const ways = { ArrowLeft: [-20, 0], ArrowRight: [20, 0], ArrowUp: [0, -20], ArrowDown: [0, 20] };
        const canvas = this.$refs.canvas;
        const at = { x: 0.75 * canvas.clientWidth, y: 0.5 * canvas.clientHeight };
        if (event.key in ways) this.send({ kind: "turn", ...at, dx: ways[event.key][0], dy: ways[event.key][1] });
        else if (event.key === "+" || event.key === "-") this.send({ kind: "zoom", ...at, factor: event.key === "+" ? 1.15 : 1 / 1.15 });
        else return;
        event.preventDefault();
      },
      wheel(event) {
        event.preventDefault();
        this.send({ kind: "zoom", ...this.at(event), factor: Math.exp(-0.0012 * event.deltaY) });
      },
    },
    render() {
      const foot = (side) => {
        const scale = this.scales[side] || { pixels: 0, words: "" };
        return h("div", { class: "scale" }, [
          h("span", { class: "length", style: { width: `${scale.pixels}px` } }),
          h("span", scale.words),
          h("span", { class: "muted" }, (this.notes || [])[side] || ""),
        ]);
      };
      return h("div", { class: "views" }, [
        h("div", { class: "frame" }, [
          h("canvas", {
            ref: "canvas",
            id: "canvas",
            tabindex: 0,
            "aria-label": "The flat sheet to the left, the opened sheet to the right",
            onPointerdown: this.press,
            onPointermove: this.move,
            onPointerup: this.release,
            onWheel: this.wheel,
            onKeydown: this.key,
            onContextmenu: (event) => event.preventDefault(),
          }),
          this.isDrawn ? null : h("div", { class: "waiting" }, "Drawing …"),
        ]),
        h("div", { class: "feet" }, [foot(0), foot(1)]),
      ]);
    },
  };

  /* Residuals over the steps, on a logarithmic axis; places come as shares. */

  const Curves = {
    props: { curves: Object },
    render() {
      const [left, right, top, width, height] = [40, 8, 8, 320, 190];
      const x = (share) => left + (width - left - right) * share;
      const y = (share) => top + (height - top - 24) * share;
      const { lines, grid, tolerance, words } = this.curves;
      const parts = grid.map((one) => [
        h("line", { class: "grid", x1: left, x2: width - right, y1: y(one.y), y2: y(one.y) }),
        h("text", { class: "axis", x: left - 5, y: y(one.y) + 4, "text-anchor": "end" }, one.words),
      ]);
      parts.push(
        h("line", { class: "tolerance", x1: left, x2: width - right, y1: y(tolerance), y2: y(tolerance) }),
        h("text", { class: "axis", x: left + 4, y: y(tolerance) - 4 }, "tolerance"),
        h("text", { class: "axis", x: x(0.5), y: height - 6, "text-anchor": "middle" }, words),
      );
      lines.forEach((line) => {
        const points = line.points.map((at) => `${x(at[0])},${y(at[1])}`).join(" ");
        const dash = line.is_dashed ? "5 3" : null;
        parts.push(h("polyline", { points, fill: "none", stroke: line.color, "stroke-width": 1.8, "stroke-dasharray": dash }));
        line.points.forEach((at) => parts.push(h("circle", { cx: x(at[0]), cy: y(at[1]), r: 1.8, fill: line.color })));
      });
      const legend = lines.map((line) =>
        h("span", [h("i", { style: { borderTop: `2px ${line.is_dashed ? "dashed" : "solid"} ${line.color}` } }), line.name]),
      );
      return h("div", { class: "curves" }, [
        h("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": words }, parts),
        h("div", { class: "legend" }, legend),
      ]);
    },
  };

  const PATHS = {
    open: "M2 13V4h4l1.5 2H14v7z",
    play: "M4 2.5v11l9-5.5z",
    stop: "M3.5 3.5h9v9h-9z",
    undo: "M6 3L2.5 6.5 6 10M3 6.5h6.5a3.5 3.5 0 0 1 0 7H7",
    redo: "M10 3l3.5 3.5L10 10M13 6.5H6.5a3.5 3.5 0 0 0 0 7H9",
    again: "M13 8a5 5 0 1 1-1.6-3.7M13 2v3h-3",
    down: "M8 2v8M4.5 7L8 10.5 11.5 7M3 13.5h10",
    more: "M4 6l4 4 4-4",
  };
  const Icon = {
    props: { name: String },
    render() {
      const filled = this.name === "play" || this.name === "stop";
      return h("svg", { class: ["icon", filled ? "filled" : ""], viewBox: "0 0 16 16", "aria-hidden": "true" }, h("path", { d: PATHS[this.name] }));
    },
  };

  /* When the server is gone, or this browser was: what is there when it comes back is shown again. */

  const Lost = {
    mounted() {
      const look = async () => {
        try {
          if ((await fetch(here, { method: "HEAD", redirect: "manual" })).type) window.location.reload();
        } catch (problem) {
          setTimeout(look, 1500);
        }
      };
      setTimeout(look, 400);
    },
    render: () =>
      h("div", { class: "lost" }, [
        h("h1", "No connection to kirisurf"),
        h("p", "While kirisurf runs in its terminal, nothing is lost: this page comes back by itself."),
        h("p", "If it was closed there, start it again: kirisurf view --web"),
      ]),
  };

  /* The value of a field to type in: a report of a fit takes nothing from what is just being typed, and a value that was
     refused does not stay. */

  const shown = (value) => (value === null || value === undefined ? "" : String(value));
  const Given = {
    mounted: (field, { value }) => { field.value = shown(value); },
    updated: (field, { value, oldValue }) => {
      if (shown(value) !== shown(oldValue) || (field !== document.activeElement && field.value !== shown(value))) {
        field.value = shown(value);
      }
    },
  };

  window.kirisurf_page = {
    install(app) {
      app.directive("given", Given);
      app.component("kirisurf-pictures", Pictures);
      app.component("kirisurf-curves", Curves);
      app.component("kirisurf-icon", Icon);
      app.component("kirisurf-lost", Lost);
      app.config.globalProperties.kirisurf = {
        open: (input) => { upload(input.files[0]); input.value = ""; },
        download,
        deploy,
        reset: () => window.kirisurfReset && window.kirisurfReset(),
      };
    },
  };
})();
