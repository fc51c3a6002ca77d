
// Values at the pointer of a figure. Everything on the page can be read without this script.
document.addEventListener('DOMContentLoaded', function () {
  'use strict';
  var NEAR = 7; // px of the view box within which a point belongs to a place
  var PULL = 20; // px within which the pointer is drawn to a point of a sparse series

  function place(axis, v, from, size) {
    var a = axis.range[0], b = axis.range[1];
    var share = axis.log ? Math.log(v / a) / Math.log(b / a) : (v - a) / (b - a);
    return from + share * size;
  }

  function printer(style) {
    var raised = '⁰¹²³⁴⁵⁶⁷⁸⁹';
    // Four digits on an axis of decades; on a linear one to a thousandth of what is shown.
    return function (v, axis) {
      if (v === 0) return '0';
      var size = Number(Math.abs(v).toPrecision(4)), power = '', text = String(size);
      var decimals = Math.max(0, Math.ceil(3 - Math.log10((axis.range[1] - axis.range[0]) / axis.per)));
      if (!axis.log && decimals <= 6) text = String(size = Number(Math.abs(v).toFixed(decimals)));
      if (size === 0) return '0';
      if (size < 1e-5 || size >= 1e7) {
        var parts = size.toExponential().split('e');
        text = parts[0];
        power = style.times + parts[1].replace('+', '').replace('-', '⁻').replace(/\d/g, function (d) { return raised[d]; });
      }
      var halves = text.split('.');
      if (halves[0].length > 4) halves[0] = halves[0].replace(/\B(?=(\d{3})+$)/g, style.group);
      return (v < 0 ? '−' : '') + halves.join(style.decimal) + power;
    };
  }

  function quantity(print, axis, values) {
    var unit = axis.unit ? (/^[°′″]$/.test(axis.unit) ? '' : '\u202f') + axis.unit : '';
    return values.map(function (v) { return print(v / axis.per, axis); }).join(' … ') + unit;
  }

  // The entry of a series at a place: the nearest point, the band or bar there, or a level.
  function found(panel, series, x, y) {
    var at = series.at, step = series.kind === 'line' || series.kind === 'points' ? 2 : 3;
    if (series.kind === 'level') return { values: at };
    var best = null, least = NEAR;
    for (var i = 0; i + step <= at.length; i += step) {
      var px = place(panel.x, at[i], panel.frame[0], panel.frame[2]);
      if (series.kind === 'bars') {
        if (x >= px && x <= place(panel.x, at[i + 1], panel.frame[0], panel.frame[2])) return { values: [at[i + 2]] };
        continue;
      }
      var far = Math.abs(px - x);
      if (series.kind === 'points' && y !== null) {
        var py = panel.frame[1] + panel.frame[3] - place(panel.y, at[i + 1], 0, panel.frame[3]);
        far = far <= NEAR ? Math.min(NEAR, far + 0.02 * Math.abs(py - y)) : NEAR + 1;
      }
      if (far <= least) {
        least = far;
        best = { x: at[i], values: at.slice(i + 1, i + step) };
      }
    }
    return best;
  }

  document.querySelectorAll('figure[data-readings]').forEach(function (figure) {
    var svg = figure.querySelector('svg');
    if (!svg || !figure.dataset.readings) return;
    var data = JSON.parse(figure.dataset.readings), print = printer(data.number);
    var rule = svg.appendChild(document.createElementNS(svg.namespaceURI, 'path'));
    rule.setAttribute('stroke', '#555');
    rule.setAttribute('stroke-width', '0.8');
    rule.setAttribute('pointer-events', 'none');
    var box = figure.appendChild(document.createElement('div'));
    box.className = 'readings';
    box.hidden = true;
    box.setAttribute('role', 'status');
    var shown = { panel: 0, x: null };

    function hide() {
      box.hidden = true;
      rule.removeAttribute('d');
    }

    function line(name, text, colour) {
      var row = box.appendChild(document.createElement('div'));
      var mark = row.appendChild(document.createElement('i'));
      mark.style.background = colour || 'transparent';
      row.appendChild(document.createElement('span')).textContent = name;
      row.appendChild(document.createElement('b')).textContent = text;
    }

    // The nearest point of the sparsest series that has one here, so that measured points are met among model curves.
    function drawn(panel, x) {
      var lists = panel.series.filter(function (s) { return (s.kind === 'line' || s.kind === 'points') && s.at.length >= 8; });
      lists.sort(function (a, b) { return a.at.length - b.at.length; });
      for (var k = 0; k < lists.length; k++) {
        var best = null, least = PULL;
        for (var i = 0; i < lists[k].at.length; i += 2) {
          var px = place(panel.x, lists[k].at[i], panel.frame[0], panel.frame[2]);
          if (Math.abs(px - x) < least) {
            least = Math.abs(px - x);
            best = px;
          }
        }
        if (best !== null) return best;
      }
      return x;
    }

    function show(index, x, y) {
      var panel = data.panels[index], frame = panel.frame, entries = [], snap = null;
      if (y !== null) x = drawn(panel, x);
      panel.series.forEach(function (s) {
        var hit = found(panel, s, x, y);
        if (!hit) return;
        entries.push([s, hit]);
        if (snap === null && (s.kind === 'line' || s.kind === 'points')) snap = hit.x;
      });
      if (!entries.some(function (e) { return e[0].kind !== 'level'; })) return hide();
      var range = panel.x.range, share = (x - frame[0]) / frame[2];
      var here = panel.x.log ? range[0] * Math.pow(range[1] / range[0], share) : range[0] + share * (range[1] - range[0]);
      var value = snap === null ? here : snap, px = place(panel.x, value, frame[0], frame[2]);
      shown = { panel: index, x: px };
      rule.setAttribute('d', 'M' + px + ' ' + frame[1] + 'v' + frame[3]);
      box.textContent = '';
      line(panel.x.name, quantity(print, panel.x, [value]));
      entries.forEach(function (e) { line(e[0].name, quantity(print, panel.y, e[1].values), e[0].colour); });
      box.hidden = false;
      var matrix = svg.getScreenCTM(), own = figure.getBoundingClientRect();
      var screen = matrix.a * px + matrix.e - own.left, top = matrix.d * frame[1] + matrix.f - own.top;
      var right = screen + 12, left = screen - 12 - box.offsetWidth;
      box.style.left = Math.max(0, right + box.offsetWidth <= own.width ? right : left) + 'px';
      box.style.top = top + 6 + 'px';
    }

    function follow(event) {
      var matrix = svg.getScreenCTM();
      var x = (event.clientX - matrix.e) / matrix.a, y = (event.clientY - matrix.f) / matrix.d;
      var index = data.panels.findIndex(function (p) {
        var f = p.frame;
        return x >= f[0] && x <= f[0] + f[2] && y >= f[1] && y <= f[1] + f[3];
      });
      if (index < 0) hide(); else show(index, x, y);
    }

    // Places at which a panel can be read, in px, for the keys.
    function stops(panel) {
      var all = [];
      panel.series.forEach(function (s) {
        if (s.kind !== 'line' && s.kind !== 'points') return;
        for (var i = 0; i < s.at.length; i += 2) all.push(Math.round(place(panel.x, s.at[i], panel.frame[0], panel.frame[2])));
      });
      return all.sort(function (a, b) { return a - b; }).filter(function (v, i, l) { return i === 0 || v !== l[i - 1]; });
    }

    function step(event) {
      if (event.key === 'Escape') return hide();
      var along = { ArrowLeft: -1, ArrowRight: 1 }[event.key], down = { ArrowUp: -1, ArrowDown: 1 }[event.key];
      if (!along && !down) return;
      var index = Math.min(Math.max(shown.panel + (box.hidden ? 0 : down || 0), 0), data.panels.length - 1);
      var panel = data.panels[index], list = stops(panel);
      if (list.length === 0) return;
      event.preventDefault();
      var from = shown.x === null ? panel.frame[0] + panel.frame[2] / 2 : shown.x;
      var next = along > 0 ? list.find(function (v) { return v > from + 0.6; }) : list.filter(function (v) { return v < from - 0.6; }).pop();
      show(index, along && next ? next : from, null);
    }

    svg.setAttribute('tabindex', '0');
    svg.addEventListener('pointermove', follow);
    svg.addEventListener('pointerdown', follow);
    svg.addEventListener('pointerleave', function (event) { if (event.pointerType === 'mouse') hide(); });
    svg.addEventListener('keydown', step);
    svg.addEventListener('blur', hide);
  });
});
