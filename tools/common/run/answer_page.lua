-- The page of an answer (hooke fit, gradient, optimise): one HTML file with its sentences, tables and diagrams, which opens from a disk,
-- needs no network and runs no script.
--
--   answer_page.write("out/fit/string/page.html", {
--     title = "string.lua: k, damping", head = "what was asked, one sentence",
--     doubts = { "a sentence", ... },                            -- none: the answer is sure
--     tables = { { title = , rows = { { "head", ... }, { "cell", ... }, ... } }, ... },
--     lines = { "a further sentence", ... },
--     figures = { { path = "out/fit/string/x", caption = }, ... } -- as plot.draw() has drawn them, path.svg
--   })
-- returns true; or nil and the reason why it cannot be written.
local files = require("common.run.file")
local escape = require("common.run.html").escape

local answer_page = {}

local style = [[
body { margin: 0 auto; padding: 1em 2em; max-width: 60em; font: 16px/1.5 sans-serif; color: #222; background: #fff; }
h1 { font-size: 1.5em; } h2 { font-size: 1.1em; margin-bottom: .3em; }
.sure, .doubt { border-left: 4px solid #1a7f4b; padding: .3em .8em; } .doubt { border-color: #b8860b; }
table { border-collapse: collapse; } td, th { border-bottom: 1px solid #ccd; padding: .2em .8em; text-align: left; }
td + td { font-variant-numeric: tabular-nums; } figure { margin: 1.5em 0; } img { max-width: 100%; } figcaption { color: #556; }
]]

local function list_of(sentences, class)
  local out = {}
  for k, text in ipairs(sentences) do out[k] = "<p>" .. escape(text) .. "</p>" end
  return #out > 0 and ('<div class="%s">%s</div>'):format(class, table.concat(out, "\n")) or ""
end

local function table_of(t)
  local out = {}
  for k, row in ipairs(t.rows) do
    local tag, cells = k == 1 and "th" or "td", {}
    for i = 1, #t.rows[#t.rows] do cells[i] = ("<%s>%s</%s>"):format(tag, escape(row[i] or ""), tag) end
    out[k] = "<tr>" .. table.concat(cells) .. "</tr>"
  end
  return (t.title and "<h2>" .. escape(t.title) .. "</h2>\n" or "") .. "<table>\n" .. table.concat(out, "\n") .. "\n</table>"
end

-- The diagram itself is inside the address of its picture; or nil and why it cannot be read.
local function figure_of(figure)
  local file, why = io.open(figure.path .. ".svg", "rb")
  if not file then return nil, why end
  local drawing = file:read("a"):gsub("[^%w%-_.~]", function(c) return ("%%%02X"):format(c:byte()) end)
  file:close()
  return ('<figure><img src="data:image/svg+xml,%s" alt="%s"><figcaption>%s</figcaption></figure>'):format(drawing,
    escape(figure.caption), escape(figure.caption))
end

function answer_page.write(path, answer)
  local out = { "<h1>" .. escape(answer.title) .. "</h1>", "<p>" .. escape(answer.head) .. "</p>" }
  if #answer.doubts > 0 then
    out[#out + 1] = list_of(answer.doubts, "doubt")
  else
    out[#out + 1] = list_of({ "Nothing was found that makes this answer unsure." }, "sure")
  end
  for _, t in ipairs(answer.tables) do out[#out + 1] = table_of(t) end
  out[#out + 1] = list_of(answer.lines or {}, "more")
  for _, figure in ipairs(answer.figures) do
    local text, why = figure_of(figure)
    if not text then return nil, why end
    out[#out + 1] = text
  end
  local head = ('<meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>%s</title><style>%s</style>'):format(
    escape(answer.title), style)
  return files.write(path, ('<!DOCTYPE html>\n<html lang="en"><head>%s</head>\n<body>\n%s\n</body></html>\n'):format(head,
    table.concat(out, "\n")))
end

return answer_page
