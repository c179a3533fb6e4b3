-- Random scenes with known answers against hooke's verdict, beside tests/adversary: here each motion is a closed form or a
-- series, not an integration. A run is wrong where its largest RMS error of all frames is above the accuracy or, without
-- one, a tenth of the way; it is a false alarm where it is not ok and its error is below a third of the bound.
local files = require("files")

local known = {}

local VISIBLE, CLEAR, SECONDS = 0.1, 1 / 3, 10
local REST = 1e-9 -- of its size: a scene that moves less is at rest

-- ---- random numbers: splitmix64, the same on every machine ----

local function generator(seed)
  local random = {}
  local function next_number()
    seed = seed + 0x9e3779b97f4a7c15
    local z = seed
    z = (z ~ (z >> 30)) * 0xbf58476d1ce4e5b9
    z = (z ~ (z >> 27)) * 0x94d049bb133111eb
    return z ~ (z >> 31)
  end
  function random.uniform(low, high) return low + (high - low) * ((next_number() >> 11) * 0x1p-53) end
  function random.log(low, high) return low * math.exp(random.uniform(0, math.log(high / low))) end
  function random.chance(p) return random.uniform(0, 1) < p end
  function random.below(n) return math.floor(random.uniform(0, n)) end
  return random
end

-- ---- scenes ----

local function families()
  local all, names = {}, {}
  for _, module in ipairs { "known_laws.contact_families", "known_laws.other_families" } do
    for name, make in pairs(require(module)) do all[name], names[#names + 1] = make, name end
  end
  table.sort(names)
  return all, names
end

-- Frames and step: hooke's in half of the cases, else well to badly resolved.
local function complete(s, random)
  s.frames = s.frames or 8 + random.below(100)
  s.fps = s.frames / s.duration
  s.duration = s.frames / s.fps
  if random.chance(0.5) then s.dt = s.duration / s.frames * random.log(s.slow and 1e-3 or 3e-3, 1) end
  if random.chance(0.3) then s.tol = random.log(1e-10, 1e-2) end
end

local function extent(s)
  local first, most = s.exact(0), 0
  for k = 1, s.frames do
    local at, sum = s.exact(k / s.fps), 0
    for e = 1, at and #at or 0 do sum = sum + (at[e] - first[e]) ^ 2 end
    most = math.max(most, math.sqrt(sum / s.n))
  end
  return most
end

local function script(s, accuracy)
  local out = { ("local scene = hooke.scene { duration = %.17g, fps = %.17g%s%s%s }"):format(s.duration, s.fps,
    s.dt and (", dt = %.17g"):format(s.dt) or "", s.tol and (", tol = %.17g"):format(s.tol) or "",
    accuracy and (", accuracy = %.17g"):format(accuracy * s.size) or "") }
  table.move(s.scene, 1, #s.scene, 2, out)
  for i = 1, s.n do
    for c = 1, 3 do
      out[#out + 1] = ("scene:measure('x%d_%d', function(s) return %ss:position(%d)[%d] end)"):format(i, c,
        s.births and ("s.n < %d and 0 or "):format(i) or "", i, c)
    end
  end
  out[#out + 1] = "return scene\n"
  return table.concat(out, "\n")
end

-- ---- runs ----

local function error_of(s, text)
  local frame, worst = -1, 0
  for row in text:gmatch("[^\n]+") do
    if frame >= 0 then
      local at, sum, e = s.exact(frame / s.fps), 0, -1
      for word in row:gmatch("[^,]+") do
        if e >= 0 and at then sum = sum + ((tonumber(word) or 0 / 0) - at[e + 1]) ^ 2 end
        e = e + 1
        if e == 3 * s.n then break end
      end
      if sum ~= sum then return math.huge end
      worst = math.max(worst, math.sqrt(sum / s.n))
    end
    frame = frame + 1
  end
  return frame == s.frames + 1 and worst or math.huge
end

local function make_run(s, o, folder, method, accuracy)
  files.write(folder .. "/scene.lua", script(s, accuracy))
  local command = ("cd %s && rm -rf out && ulimit -t %d && %s run scene.lua --integrator %s --threads 1 --json --out out"):format(
    files.quoted(folder), o.seconds or SECONDS, files.quoted(o.hooke), method)
  local _, how, code = os.execute(command .. " >json 2>err </dev/null")
  local json, r = files.read(folder .. "/json") or "", { method = method, accuracy = accuracy, dt = s.dt }
  r.reason = json:match('"reason":"(.-)"[,}]') or files.read(folder .. "/err") or ""
  r.bound = accuracy and accuracy * s.size or VISIBLE * math.max(s.extent, REST * s.size)
  if how == "signal" or code > 128 then r.kind = "too long" return r end
  if code == 1 or code == 2 then r.kind = "refused" return r end
  r.error = error_of(s, files.read(folder .. "/out/measures.csv") or "")
  local ok, wrong = code == 0, r.error > r.bound
  if not ok and code ~= 3 and code ~= 5 then r.kind = "broken"
  -- Nobody has asked for an accuracy, the method damps by design, and the verdict says what it damps.
  elseif ok and wrong and json:find("damps what swings faster", 1, true) then r.kind = "damped"
  elseif ok then r.kind = not wrong and "ok" or accuracy and "OK+WRONG" or "visible"
  elseif wrong then r.kind = "rightly"
  else r.kind = r.error < CLEAR * r.bound and "false alarm" or "close" end
  return r
end

-- ---- counting ----

local kinds = { "ok", "OK+WRONG", "visible", "damped", "rightly", "close", "false alarm", "refused", "too long", "broken" }

local function print_table(title, counts, names)
  io.write(("\n%-18s"):format(title))
  for _, kind in ipairs(kinds) do io.write(("%12s"):format(kind)) end
  io.write("\n")
  for _, name in ipairs(names) do
    io.write(("%-18s"):format(name))
    for _, kind in ipairs(kinds) do io.write(("%12d"):format(counts[name] and counts[name][kind] or 0)) end
    io.write("\n")
  end
end

local function count(into, name, kind)
  into[name] = into[name] or {}
  into[name][kind] = (into[name][kind] or 0) + 1
end

local function methods_of(build)
  local list, pipe = {}, assert(io.popen("ls " .. files.quoted(build) .. "/plugins/integrators"))
  for line in pipe:lines() do list[#list + 1] = line:match("^(.*)%.so$") end
  pipe:close()
  return list
end

-- o: hooke, build, seed, cases, runs of each case, families, methods, accuracies (lists or nil), list, one (seed of a
-- scene), folder. Returns the counts of all kinds.
function known.measure(o)
  local all, names = families()
  names = o.families or names
  local methods, accuracies = o.methods or methods_of(o.build), o.accuracies or { 1e-2, 1e-4, 1e-6, false }
  local by_family, by_method, total, seeds = {}, {}, {}, generator(o.seed)
  for case = 1, o.cases do
    local family = names[(case - 1) % #names + 1]
    local seed = o.one and o.seed or math.floor(seeds.uniform(0, 2 ^ 52))
    local random = generator(seed)
    local s = all[family](random)
    complete(s, random)
    s.extent = extent(s)
    for k = 1, o.one and #methods * #accuracies or o.runs do
      local method, accuracy = methods[(k - 1) % #methods + 1], accuracies[(k - 1) // #methods + 1]
      if not o.one then method, accuracy = methods[random.below(#methods) + 1], accuracies[random.below(#accuracies) + 1] end
      local r = make_run(s, o, o.folder, method, accuracy or nil)
      count(by_family, family, r.kind)
      count(by_method, method, r.kind)
      count(total, "together", r.kind)
      if r.kind == "OK+WRONG" or r.kind == "visible" or r.kind == "broken" or o.list and r.kind == "false alarm" or o.one then
        print(("%s: --one %s --seed %d --methods %s --accuracies %s: error %.3g, bound %.3g, dt %s, %s"):format(r.kind, family,
          seed, method, accuracy or "none", r.error or 0 / 0, r.bound, s.dt or "chosen", r.reason))
        io.stdout:flush()
      end
    end
  end
  print_table("family", by_family, names)
  print_table("method", by_method, methods)
  print_table("all", total, { "together" })
  return total.together
end

-- The words of a command line as options.
function known.options(words)
  local o, k = { seed = 1, cases = 60, runs = 2 }, 1
  local function list(text)
    local out = {}
    for word in text:gmatch("[^,]+") do out[#out + 1] = tonumber(word) or word ~= "none" and word or false end
    return out
  end
  while words[k] do
    local name = words[k]:match("^%-%-(%w+)$")
    if name == "list" then
      o.list, k = true, k + 1
    else
      local value = words[k + 1]
      if name == "one" then o.one, o.families, o.cases = true, { value }, 1
      elseif name == "family" then o.families = list(value)
      elseif name == "methods" or name == "accuracies" then o[name] = list(value)
      elseif name == "hooke" then o.hooke = value
      else o[name] = tonumber(value) end
      k = k + 2
    end
  end
  return o
end

return known
