-- The page as one file: its markup, style and modules (tools/view), three.js with its licence, and packed data, each in
-- a script element that the browser does not run. A nonce allows the page's own scripts and nothing else; there is no
-- network. Data come between `begin` and `finish`, so that a page of any size is never in memory.
local lfs = require("lfs")
local json_text = require("common.view.json_text")
local three = require("common.view.three")

local template = {}

-- In this order: a module uses those before it.
template.modules = { "begin", "dom", "numbers", "codec", "recorded", "colours", "light", "buffers", "sight", "surface", "segments",
  "points", "trails", "splats", "floor", "solids", "orbit", "topology", "layer", "stage", "economy", "clock", "timeline", "plots",
  "controls", "compare", "inspector", "report", "bench", "app" }

local function read(path)
  local file, why = io.open(path, "rb")
  if not file then return nil, why end
  local text = file:read("a")
  file:close()
  return text
end

local function nonce()
  local file = assert(io.open("/dev/urandom", "rb"))
  local bytes = file:read(18)
  file:close()
  return (bytes:gsub(".", function(c) return ("%02x"):format(c:byte()) end))
end

local entities = { ["&"] = "&amp;", ["<"] = "&lt;", [">"] = "&gt;", ['"'] = "&quot;", ["'"] = "&#39;" }

local function markup(text) return (text:gsub("[&<>\"']", entities)) end

-- {{name}} by its value, in one pass: a value is never looked at again.
local function fill(text, values)
  return (text:gsub("{{(%w+)}}", function(name) return values[name] end))
end

local function script(number_used_once, text)
  return ('<script nonce="%s">\n'):format(number_used_once) .. text .. "</script>\n"
end

-- The page's parts up to where data come, and from there: nil and the reason where a file is missing.
-- what: title, subtitle, policy (more of the Content-Security-Policy), modules (those behind them; the last opens the
-- page), three (where three.js may be; left out: three.places)
function template.parts(what)
  local folder = hooke.folder .. "/view/"
  local library, why = three.script(what.three)
  if not library then return nil, why end
  local used = what.nonce or nonce()
  local scripts = { script(used, library) }
  local modules = table.move(template.modules, 1, #template.modules, 1, {})
  table.move(what.modules or { "open" }, 1, #(what.modules or { "open" }), #modules + 1, modules)
  for _, name in ipairs(modules) do
    local text
    text, why = read(folder .. name .. ".js")
    if not text then return nil, why end
    scripts[#scripts + 1] = script(used, text)
  end
  local page, style = read(folder .. "page.html"), read(folder .. "page.css")
  if not (page and style) then return nil, "the page's files are missing in " .. folder end
  local before, after = page:match("^(.-){{scripts}}(.*)$")
  local values = { nonce = used, title = markup(what.title), subtitle = markup(what.subtitle or ""), style = style,
    policy = what.policy or "" }
  return fill(before, values), table.concat(scripts) .. fill(after, values)
end

-- ---- a page of recorded runs ----

local page = {}
page.__index = page

-- Begins the file; nil and the reason where it cannot be. A device is written directly.
function template.begin(path, what)
  local before, after = template.parts(what)
  if not before then return nil, after end
  local mode = lfs.attributes(path, "mode")
  local direct = mode ~= nil and mode ~= "file"
  local part = direct and path or path .. ".part"
  local file, why
  if direct then file, why = io.open(part, "wb") else file, why = hooke.create(part) end
  if not file then return nil, ("cannot write %s: %s"):format(path, why:match(": (.*)$") or why) end
  local self = setmetatable({ path = path, part = part, file = file, after = after, count = 0, size = 0 }, page)
  self:write(before)
  return self
end

function page:write(text)
  self.size = self.size + #text
  local fine, why = self.file:write(text)
  if not fine and not self.failed then self.failed = why end
end

-- Adds packed text; its id in the page.
function page:add(packed)
  self.count = self.count + 1
  local id = "d" .. self.count
  self:write(('<script type="text/plain" id="%s">%s</script>\n'):format(id, packed))
  return id
end

-- Ends the page with its data. true and its size in bytes, or nil and the reason.
function page:finish(page_data)
  self:write('<script type="application/json" id="page-data">' .. json_text.encode(page_data) .. "</script>\n")
  self:write(self.after)
  local closed, why = self.file:close()
  self.closed = true
  local failed = self.failed or not closed and why
  if not failed and self.part ~= self.path then
    local renamed, reason = os.rename(self.part, self.path)
    failed = not renamed and reason
  end
  self.kept = not failed
  if self.kept then return true, self.size end
  return nil, ("cannot write %s: %s"):format(self.path, failed)
end

-- A page that was not finished leaves no file.
function page:close()
  if not self.closed then self.file:close() end
  if not self.kept and self.part ~= self.path then os.remove(self.part) end
end

return template
