-- A page of recorded runs in a browser, and what is seen in it.
local seen = {}

-- b: a browser (browser.lua); folder: where the pages are.
function seen.of(b, folder)
  local function open(name)
    b:go(("file://%s/%s.html"):format(folder, name))
    b:wait("view.page && view.page.layers[0].frame")
    b:eval("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
  end

  local function silent(where)
    local list = b:complaints()
    assert(#list == 0, ("%s: the console has: %s"):format(where, table.concat(list, "\n")))
  end

  -- Moves to frame k, and waits until it is shown.
  local function show(k)
    b:eval(("view.page.clock.seek(%d)"):format(k))
    b:wait(("view.page.layers[0].frame.k === %d"):format(k))
  end

  -- Where particle i is on the page: x, y.
  local function place(i)
    local p = b:eval(([[(() => {
      const { stage, layers } = view.page, { frame } = layers[0], v = new THREE.Vector3(...frame.x.subarray(3 * %d, 3 * %d + 3));
      stage.render();
      v.applyMatrix4(layers[0].group.matrixWorld).project(stage.orbit.camera);
      const box = stage.canvas.getBoundingClientRect();
      return [box.left + (v.x + 1) / 2 * box.width, box.top + (1 - v.y) / 2 * box.height];
    })()]]):format(i, i))
    return math.floor(p[1] + 0.5), math.floor(p[2] + 0.5)
  end

  -- Red, green, blue and opacity of the canvas there, 0 to 255.
  local function pixel(x, y)
    return table.unpack(b:eval(([[(() => {
      const { stage } = view.page, gl = stage.renderer.getContext(), box = stage.canvas.getBoundingClientRect();
      stage.render();
      const got = new Uint8Array(4);
      gl.readPixels(Math.round(%d - box.left), Math.round(box.bottom - %d), 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, got);
      return [...got];
    })()]]):format(x, y)))
  end

  return open, silent, show, place, pixel
end

return seen
