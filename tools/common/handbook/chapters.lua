-- The chapters of the handbook that are made from tables: scenes, plugins, commands, words.
local markdown = require("common.handbook.markdown")
local page = require("common.handbook.page")
local plugin_entry = require("common.handbook.plugin_entry")
local reference = require("common.handbook.reference")

local chapters = {}

local function heading(name, title)
  return ('<h3 id="%s">%s</h3>'):format(markdown.escape(name), title)
end

local function entry(e)
  local out = { heading(e.name, "<code>" .. markdown.escape(e.form) .. "</code>") }
  out[#out + 1] = "<p>" .. markdown.inline(e.text) .. (e.gives and " Gives " .. markdown.inline(e.gives) .. "." or "") .. "</p>"
  if e.takes then
    local rows = { { "key", "unit", "default", "" } }
    for _, row in ipairs(e.takes) do rows[#rows + 1] = { "`" .. row.name .. "`", row.unit, row.default, row.text } end
    out[#out + 1] = page.table(rows)
  end
  if e.example and e.example ~= "" then out[#out + 1] = "<pre>" .. markdown.escape(e.example) .. "</pre>" end
  return table.concat(out, "\n")
end

function chapters.language()
  local out = { "<h1>The language of scenes</h1><p>All that a script may call. `hooke help WORD` prints the same entries.</p>" }
  out[1] = out[1]:gsub("`(.-)`", "<code>%1</code>")
  for _, part in ipairs(reference.parts) do
    out[#out + 1] = "<h2>" .. part.title .. "</h2>"
    for _, e in ipairs(part.entries) do out[#out + 1] = entry(e) end
  end
  return table.concat(out, "\n")
end

local function plugin(p)
  local out = { heading(p.name, markdown.escape(p.name)), "<p>" .. markdown.inline(p.summary) .. "</p>" }
  for _, fact in ipairs(plugin_entry.facts(p)) do
    out[#out + 1] = ("<p>%s: %s</p>"):format(fact[1], markdown.inline(fact[2]))
  end
  local rows = { { "parameter", "unit", "type", "default", "range", "" } }
  for _, q in ipairs(p.params) do
    rows[#rows + 1] = { "`" .. q.name .. "`", q.unit, q.type, plugin_entry.default(q), plugin_entry.range(q), q.help }
  end
  if #rows > 1 then out[#out + 1] = page.table(rows) end
  return table.concat(out, "\n")
end

-- Of all plugins of a kind.
function chapters.plugins(kind, plugins)
  local out = { ("<h1>%ss</h1>"):format(kind:gsub("^%l", string.upper)) }
  if kind == "force" then
    out[#out + 1] = "<p>Every force also takes <code>label</code>, <code>only</code> (ids) or <code>group</code>, <code>from</code> and "
      .. "<code>to</code> (s).</p>"
  end
  for _, p in ipairs(plugins) do
    if p.kind == kind then out[#out + 1] = plugin(p) end
  end
  return table.concat(out, "\n")
end

-- `help`: { { name, text } }, what each command says of itself; more: { name = what else is to be said, in Markdown }.
function chapters.commands(help, more)
  local out = { "<h1>Commands and options</h1>" }
  for _, command in ipairs(help) do
    out[#out + 1] = heading(command.name, "hooke " .. markdown.escape(command.name))
    out[#out + 1] = "<pre>" .. markdown.escape(command.text) .. "</pre>"
    if more[command.name] then out[#out + 1] = markdown.html(more[command.name]) end
  end
  return table.concat(out, "\n")
end

return chapters
