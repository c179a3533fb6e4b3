-- hooke docs [FOLDER]: writes the handbook: lessons that are run, a reference, annotations for editors.
local annotations = require("common.handbook.annotations")
local argparse = require("argparse")
local chapters = require("common.handbook.chapters")
local command_line = require("common.run.command_line")
local files = require("common.run.file")
local lessons = require("common.handbook.lessons")
local lfs = require("lfs")
local manual_page = require("common.handbook.manual_page")
local page = require("common.handbook.page")

local kinds = { "force", "constraint", "corrector", "source", "integrator", "solver", "output", "service" }
local texts = hooke.library .. "/../handbook"

local function parser_of()
  local p = argparse("hooke docs", "The handbook as HTML that opens without a server: FOLDER/index.html. Its lessons are run.")
  p:argument("folder", "where it goes (out/handbook)"):args("?")
  p:option("--annotations", "write these alone, for Lua's language server, to that file")
  p:option("--manual", "write the language of scenes alone, as a manual page, to that file")
  p:flag("--no-pictures", "without the pictures of the lessons")
  p:flag("--quiet", "say nothing")
  return p
end

-- The texts of a kind of page, "^%d" for lessons, in order.
local function texts_of(pattern, group)
  local list = {}
  for name in lfs.dir(texts) do
    if name:find(pattern) and name:find("%.md$") then
      local text = lessons.read(texts .. "/" .. name)
      list[#list + 1] = { file = name:gsub("%.md$", ".html"), title = text:match("^# ([^\n]+)"), group = group, text = text }
    end
  end
  local function number(p) return tonumber(p.file:match("^%d+")) or 0 end -- lesson 10 is behind lesson 9
  table.sort(list, function(a, b) return number(a) ~= number(b) and number(a) < number(b) or number(a) == number(b) and a.file < b.file end)
  return list
end

-- A section of a README, whose words are the handbook's, too; its links lead to files that are not here. "": it has none.
local function section(text, title)
  local begin = text:find("\n## " .. title .. "\n", 1, true)
  if not begin then return "" end
  local last = (text:find("\n## ", begin + 1, true) or #text) - 1
  return (text:sub(begin + 2, last):gsub("%[([^%]]+)%]%(([^%)%s]+)%)", function(words, to)
    return not to:find("^https?:") and words or nil
  end))
end

local function ask(command)
  local pipe = assert(io.popen(("'%s' %s 2>&1"):format(lfs.symlinkattributes("/proc/self/exe", "target"), command)))
  local text = pipe:read("a")
  pipe:close()
  return text
end

local function help()
  local list = {}
  for name in ask("--help"):gmatch("\n  hooke ([%a_]+)") do list[#list + 1] = { name = name, text = ask(name .. " --help") } end
  return list
end

-- The words of the house, where its sources are.
local function words()
  local file = io.open(hooke.folder .. "/../core/README.md")
  if not file then return {} end
  local text = file:read("a")
  file:close()
  return { { file = "words.html", title = "Words", group = "Reference", text = section(text, "Words") } }
end

-- The sections of a text, by their titles.
local function sections(text)
  local found, title = {}, nil
  for line in text:gmatch("([^\n]*)\n") do
    title = line:match("^## (.*)") or title
    if title and not line:find("^## ") then found[title] = (found[title] or "") .. line .. "\n" end
  end
  return found
end

local function all_pages(plugins)
  local pages = { { file = "index.html", title = "hooke", group = "Handbook", text = lessons.read(texts .. "/index.md") } }
  local function add(list) table.move(list, 1, #list, #pages + 1, pages) end
  add(texts_of("^%d", "Lessons"))
  add { { file = "which-integrator.html", title = "Which integrator", group = "Decisions",
    text = section(lessons.read(texts .. "/../README.md"), "Which integrator") } }
  add(texts_of("^%l.*%-", "Decisions"))
  add { { file = "language.html", title = "The language of scenes", group = "Reference", body = chapters.language } }
  for _, kind in ipairs(kinds) do
    add { { file = kind .. "s.html", title = kind:gsub("^%l", string.upper) .. "s", group = "Reference",
      body = function() return chapters.plugins(kind, plugins) end } }
  end
  add { { file = "commands.html", title = "Commands and options", group = "Reference",
    body = function() return chapters.commands(help(), sections(lessons.read(texts .. "/commands.md"))) end } }
  add { { file = "glossary.html", title = "Glossary", group = "Reference", text = lessons.read(texts .. "/glossary.md") } }
  add(words())
  return pages
end

local function has(plugins, name)
  for _, plugin in ipairs(plugins) do
    if plugin.name == name then return true end
  end
  return false
end

local function write(folder, options)
  local plugins = hooke.catalogue()
  local pages = all_pages(plugins)
  local made, refused = files.make_folder(folder)
  if not made then error({ sentence = refused }) end
  for _, p in ipairs(pages) do
    if not options.quiet then print(("%s/%s"):format(folder, p.file)) end
    local body = p.body and p.body() or lessons.html(p.text, folder, not options.no_pictures and has(plugins, "frames"))
    local fine, why = files.write(("%s/%s"):format(folder, p.file), page.html(pages, p, body))
    if not fine then error({ sentence = why }) end
  end
  assert(files.write(folder .. "/hooke.d.lua", annotations.text(plugins)))
end

local options = command_line.parse("docs", parser_of())
if not options then return 1 end
-- One file alone, where that is asked for; or the whole.
local function make()
  local alone = options.annotations or options.manual
  if not alone then return write(options.folder or "out/handbook", options) end
  local fine, why = files.write(alone, options.annotations and annotations.text((hooke.catalogue())) or manual_page.text())
  if not fine then error({ sentence = why }) end
end

local fine, why = pcall(make)
if fine then return 0 end
if type(why) ~= "table" then error(why, 0) end
command_line.complain("docs", why.sentence)
return 4
