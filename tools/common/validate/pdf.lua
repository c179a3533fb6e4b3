-- validate.pdf, by gnuplot: pages of A4 with the tables, set as labels at fixed places, then the figures of the topics.
local files = require("common.run.file")
local lines = require("common.validate.lines")
local panels = require("common.validate.panels")
local plot = require("common.run.plot")

local pdf = {}

local rows_on_page, panel_rows = 66, 4
local top, line_height = 0.955, 0.0138 -- of the page's height
local places = { quantity = 0.06, reference = 0.53, value = 0.70, digits = 0.765, space = 0.85, time = 0.94 } -- its width
local most_title, most_source = 60, 118 -- characters that fit

local function label(text, x, y, font, align)
  return ("set label %s at screen %.4f,%.4f %s font '%s' noenhanced"):format(plot.quote(text), x, y, align or "left", font)
end

-- Breaks a text into lines of at most `most` characters, at spaces.
local function wrapped(text, most)
  local list, line = {}, ""
  for word in text:gmatch("%S+") do
    if #line + #word + 1 > most and line ~= "" then
      list[#list + 1], line = line, word
    else
      line = line == "" and word or line .. " " .. word
    end
  end
  if line ~= "" then list[#list + 1] = line end
  return list
end

local function order_text(found, axis)
  local text, expected = lines.order_text(found[axis]), found.quantity.order[axis]
  return text and (expected and ("%s (%g)"):format(text, expected) or text) or ""
end

-- ---- lines of the tables: functions of y that give commands, in blocks that stay on one page ----

local function heading(topic)
  return function(y, add)
    add(label(topic.name, places.quantity, y, "Sans:Bold,10"))
    for name, text in pairs { reference = "reference", value = "hooke", digits = "digits", space = "order in space",
      time = "in time" } do
      add(label(text, places[name], y, "Sans:Italic,7", "right"))
    end
  end
end

local function quantity_line(found)
  return function(y, add)
    local q = found.quantity
    add(label(q.name .. (q.unit and ", " .. q.unit or ""), places.quantity + 0.012, y, "Sans,7"))
    add(label(("%.12g"):format(q.reference), places.reference, y, "Sans,7", "right"))
    add(label(lines.value_text(found), places.value, y, "Sans,7", "right"))
    add(label(("%.1f"):format(found.digits), places.digits, y, "Sans,7", "right"))
    add(label(order_text(found, "space"), places.space, y, "Sans,7", "right"))
    add(label(order_text(found, "time"), places.time, y, "Sans,7", "right"))
  end
end

local function plain_line(text, font, indent)
  return function(y, add) add(label(text, places.quantity + indent, y, font)) end
end

local function block_of(problem, sources)
  local block = { plain_line(problem.description.title:sub(1, 2 * most_title), "Sans:Bold,7", 0) }
  for _, text in ipairs(wrapped(sources(problem), most_source)) do
    block[#block + 1] = plain_line(text, "Sans:Italic,6", 0.012)
  end
  if problem.failed then block[#block + 1] = plain_line("failed: " .. problem.failed, "Sans:Bold,7", 0.012) end
  for _, found in ipairs(problem.found) do
    block[#block + 1] = quantity_line(found)
    for _, fault in ipairs(found.faults) do block[#block + 1] = plain_line("wrong: " .. fault, "Sans:Bold,7", 0.03) end
  end
  return block
end

-- Lists of lines, a page each. A block longer than what is left begins a page, if it fits there.
local function paginate(topics, sources)
  local pages, page = {}, {}
  local function turn()
    if #page > 0 then pages[#pages + 1] = page end
    page = {}
  end
  for _, topic in ipairs(topics) do
    if #page > rows_on_page - 8 then turn() end
    if #page > 0 then page[#page + 1] = function() end end
    page[#page + 1] = heading(topic)
    for _, problem in ipairs(topic.problems) do
      local block = block_of(problem, sources)
      if #page + #block > rows_on_page then
        turn()
        page[1] = heading(topic)
      end
      for _, line in ipairs(block) do
        if #page >= rows_on_page then turn() end
        page[#page + 1] = line
      end
    end
  end
  turn()
  return pages
end

local function page_script(page)
  local text = { "unset label" }
  local function add(command) text[#text + 1] = command end
  for k, line in ipairs(page) do line(top - (k - 1) * line_height, add) end
  text[#text + 1] = "plot NaN notitle"
  return table.concat(text, "\n")
end

local function figure_pages(topic)
  local text, per_page = { panels.data(topic.panels) }, 3 * panel_rows
  for first = 1, #topic.panels, per_page do
    local last = math.min(first + per_page - 1, #topic.panels)
    local rows = panels.rows(last - first + 1)
    text[#text + 1] = ("set size 1,1\n%s"):format(panels.script(topic.panels, first, last, rows, topic.name))
  end
  return table.concat(text, "\n")
end

-- The whole script: terminal, tables, figures.
local function script(topics, sources)
  local text = { "set terminal pdfcairo size 21cm,29.7cm font 'Sans,7'", "set output 'validate.pdf'" }
  text[#text + 1] = "unset border; unset tics; unset key; set xrange [0:1]; set yrange [0:1]; set margins 0,0,0,0"
  for _, page in ipairs(paginate(topics, sources)) do text[#text + 1] = page_script(page) end
  for _, topic in ipairs(topics) do
    if #topic.panels > 0 then text[#text + 1] = "reset\n" .. figure_pages(topic) end
  end
  return table.concat(text, "\n") .. "\n"
end

-- topics: { name =, problems =, panels = }; sources(problem) gives the text of its sources.
function pdf.write(topics, o, sources)
  local fine, why = files.write(o.out .. "/validate.gp", script(topics, sources))
  if not fine then return nil, why end
  why = plot.gnuplot(o.out, "load 'validate.gp'")
  return why == nil, why
end

return pdf
