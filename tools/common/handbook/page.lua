-- A page of the handbook: one HTML file with its style, a list of all pages at its side, and no script.
local markdown = require("common.handbook.markdown")

local page = {}

local style = [[
body { margin: 0; font: 16px/1.5 sans-serif; color: #222; background: #fff; display: flex; }
nav { width: 15em; flex: none; padding: 1em; background: #f3f5f7; min-height: 100vh; box-sizing: border-box; }
nav a { display: block; color: #146; text-decoration: none; } nav a.here { font-weight: bold; } nav h2 { font-size: 1em; margin: 1em 0 0; }
main { padding: 1em 2em; max-width: 60em; min-width: 0; }
pre { background: #f3f5f7; padding: .6em .8em; white-space: pre-wrap; font-size: 13px; }
pre.output { border-left: 4px solid #9bc; }
pre.scene { border-left: 4px solid #9c9; } code { background: #f3f5f7; padding: 0 .2em; }
table { border-collapse: collapse; } td, th { border: 1px solid #ccd; padding: .2em .5em; text-align: left; vertical-align: top; }
img { max-width: 100%; } figure { margin: 1em 0; } figcaption { color: #556; font-size: 14px; } h3 { margin-bottom: 0; }
@media (max-width: 700px) { body { display: block; } nav { width: auto; min-height: 0; } main { padding: 1em; } }
]]

-- `pages`: { { file, title, group } } in the order of the list.
function page.html(pages, here, body)
  local links, group = {}, nil
  for _, p in ipairs(pages) do
    if p.group ~= group then
      group = p.group
      links[#links + 1] = "<h2>" .. markdown.escape(group) .. "</h2>"
    end
    links[#links + 1] = ('<a href="%s"%s>%s</a>'):format(p.file, p.file == here.file and ' class="here"' or "", markdown.escape(p.title))
  end
  return ('<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">'
    .. "<title>hooke: %s</title><style>%s</style></head>\n<body><nav>%s</nav><main>%s</main></body></html>\n"):format(
    markdown.escape(here.title), style, table.concat(links, "\n"), body)
end

-- A table of parameters: rows of texts, the first one the heads.
function page.table(rows)
  local out = {}
  for k, row in ipairs(rows) do
    local tag, line = k == 1 and "th" or "td", {}
    for _, cell in ipairs(row) do line[#line + 1] = ("<%s>%s</%s>"):format(tag, markdown.inline(cell), tag) end
    out[#out + 1] = "<tr>" .. table.concat(line) .. "</tr>"
  end
  return "<table>" .. table.concat(out, "\n") .. "</table>"
end

return page
