-- The part of Markdown that the handbook uses, as HTML: headings, paragraphs, lists, tables, code, links, **bold**. Code with a
-- word behind its fence ("```run") is given to the function of that name.
local markdown = {}

markdown.escape = require("common.run.html").escape

-- What stands in a line; code goes first, and nothing in it is changed.
local function inline(text)
  local code = {}
  text = text:gsub("`([^`]+)`", function(inside)
    code[#code + 1] = "<code>" .. markdown.escape(inside) .. "</code>"
    return "\1" .. #code .. "\1"
  end)
  text = markdown.escape(text):gsub("%[([^%]]+)%]%(([^%)%s]+)%)", '<a href="%2">%1</a>'):gsub("%*%*(.-)%*%*", "<b>%1</b>")
  return (text:gsub("\1(%d+)\1", function(k) return code[tonumber(k)] end))
end
markdown.inline = inline

local function cells(line, tag)
  local row = {}
  for cell in line:gsub("\\|", "\2"):gmatch("|([^|]+)") do
    row[#row + 1] = ("<%s>%s</%s>"):format(tag, inline((cell:gsub("\2", "|"):match("^%s*(.-)%s*$"))), tag)
  end
  return "<tr>" .. table.concat(row) .. "</tr>"
end

-- Lines from k on that begin as `pattern` says, and the number of the next.
local function while_matching(lines, k, pattern)
  local taken = {}
  while lines[k] and lines[k]:find(pattern) do
    taken[#taken + 1] = lines[k]
    k = k + 1
  end
  return taken, k
end

local blocks = {}

function blocks.table(lines, k)
  local rows, next_line = while_matching(lines, k, "^|")
  local out = { cells(rows[1], "th") }
  for r = 3, #rows do out[#out + 1] = cells(rows[r], "td") end
  return "<table>" .. table.concat(out, "\n") .. "</table>", next_line
end

function blocks.list(lines, k)
  local items = {}
  while lines[k] and lines[k]:find("^%- ") do
    local more, after = while_matching(lines, k + 1, "^  %S")
    items[#items + 1] = "<li>" .. inline(lines[k]:sub(3) .. " " .. table.concat(more, " ")) .. "</li>"
    k = after
  end
  return "<ul>" .. table.concat(items, "\n") .. "</ul>", k
end

function blocks.code(lines, k, special)
  local word, rest = lines[k]:match("^```(%a*)%s*(.*)$")
  local text = {}
  k = k + 1
  while lines[k] and lines[k] ~= "```" do
    text[#text + 1] = lines[k]
    k = k + 1
  end
  local whole = table.concat(text, "\n")
  if special[word] then return special[word](whole, rest), k + 1 end
  return "<pre>" .. markdown.escape(whole) .. "</pre>", k + 1
end

function blocks.heading(lines, k)
  local marks, text = lines[k]:match("^(#+) (.*)$")
  return ("<h%d>%s</h%d>"):format(#marks, inline(text), #marks), k + 1
end

local begins = { { "^```", "code" }, { "^#", "heading" }, { "^|", "table" }, { "^%- ", "list" } }

-- The kind of block that begins with the line; nil: the line is blank.
local function kind_of(line)
  for _, b in ipairs(begins) do
    if line:find(b[1]) then return b[2] end
  end
  return line:find("%S") and "paragraph" or nil
end

function blocks.paragraph(lines, k)
  local text = {}
  repeat
    text[#text + 1] = lines[k]
    k = k + 1
  until not lines[k] or kind_of(lines[k]) ~= "paragraph"
  return "<p>" .. inline(table.concat(text, " ")) .. "</p>", k
end

-- `special`: { word = function(text, rest of the fence's line) -> HTML }.
function markdown.html(text, special)
  local lines, out, k = {}, {}, 1
  for line in (text .. "\n"):gmatch("(.-)\n") do lines[#lines + 1] = line end
  while lines[k] do
    local kind = kind_of(lines[k])
    if kind then out[#out + 1], k = blocks[kind](lines, k, special or {}) else k = k + 1 end
  end
  return table.concat(out, "\n")
end

return markdown
