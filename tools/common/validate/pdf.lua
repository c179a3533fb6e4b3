-- validate.pdf, by gnuplot: pages of A4 with the tables, set as labels at fixed places, then the figures of the topics.
local files = require("common.run.file")
local lines = require("common.validate.lines")
local panels = require("common.validate.panels")
local plot = require("common.run.plot")

local pdf = {}

local rows_on_page, panel_rows = 75, 4
local top, line_height = 0.955, 0.0121 -- of the page's height
local places = { quantity = 0.06, reference = 0.54, value = 0.69, digits = 0.745, space = 0.84, time = 0.94 } -- of its width
local most_name, most_source, most_text = 60, 130, 112 -- characters that fit
local text_font, small_font, bold_font = "Sans,6.5", "Sans:Italic,5.5", "Sans:Bold,6.5"

local function label(text, x, y, font, align)
  return ("set label %s at screen %.4f,%.4f %s font '%s' noenhanced"):format(plot.text(text), x, y, align or "left", font)
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

-- ---- lines of the tables: a height in lines, and draw(y, add), which gives commands ----

local function plain_line(text, font, indent, height)
  return { height = height or 1, draw = function(y, add) add(label(text, places.quantity + indent, y, font)) end }
end

local function heading(topic)
  return { height = 2, draw = function(y, add)
    add(label(topic.name, places.quantity, y, "Sans:Bold,9"))
    for name, text in pairs { reference = "reference", value = "hooke", digits = "digits", space = "order, space",
      time = "order, time" } do
      add(label(text, places[name], y, "Sans:Italic,6", "right"))
    end
    add(("set arrow from screen %.3f,%.4f to screen %.3f,%.4f nohead lw 0.6"):format(places.quantity, y - 0.0075,
      places.time, y - 0.0075))
  end }
end

local function quantity_line(found)
  return { height = 1, draw = function(y, add)
    local q = found.quantity
    local name = q.name .. (q.unit and ", " .. q.unit or "")
    add(label(panels.shortened(name, most_name), places.quantity + 0.012, y, text_font))
    local cells = { reference = ("%.11g"):format(q.reference), value = lines.value_text(found, 11),
      digits = ("%.1f"):format(found.digits), space = lines.order_cell(found, "space"),
      time = lines.order_cell(found, "time") }
    for place, text in pairs(cells) do add(label(text, places[place], y, text_font, "right")) end
  end }
end

local function block_of(problem, sources)
  local block = { plain_line(problem.title, bold_font, 0, 1.3) }
  for _, text in ipairs(wrapped(sources(problem), most_source)) do
    block[#block + 1] = plain_line(text, small_font, 0.012, 0.9)
  end
  if problem.failed then block[#block + 1] = plain_line("failed: " .. problem.failed, bold_font, 0.012) end
  for _, found in ipairs(problem.found) do
    block[#block + 1] = quantity_line(found)
    for _, fault in ipairs(found.faults) do block[#block + 1] = plain_line("wrong: " .. fault, bold_font, 0.03) end
  end
  return block
end

local function height_of(list)
  local sum = 0
  for _, line in ipairs(list) do sum = sum + line.height end
  return sum
end

-- Lists of lines, a page each. A problem that does not fit into what is left of a page begins the next one.
local function paginate(topics, sources, introduction)
  local pages, page = {}, { plain_line("Validation of hooke", "Sans:Bold,11", 0, 1.6) }
  local function turn()
    pages[#pages + 1], page = page, {}
  end
  for _, text in ipairs(wrapped(introduction, most_text)) do page[#page + 1] = plain_line(text, text_font, 0, #page == 1 and 1.4 or 1) end
  for _, topic in ipairs(topics) do
    if height_of(page) > rows_on_page - 8 then turn() end
    page[#page + 1] = heading(topic)
    for _, problem in ipairs(topic.problems) do
      local block = block_of(problem, sources)
      if height_of(page) + height_of(block) > rows_on_page then
        turn()
        page[1] = heading(topic)
      end
      for _, line in ipairs(block) do
        if height_of(page) >= rows_on_page then turn() end
        page[#page + 1] = line
      end
    end
  end
  turn()
  return pages
end

local function page_script(page)
  local text, y = { "unset label", "unset arrow" }, top + line_height
  local function add(command) text[#text + 1] = command end
  for _, line in ipairs(page) do
    y = y - line.height * line_height
    line.draw(y, add)
  end
  text[#text + 1] = "plot NaN notitle"
  return table.concat(text, "\n")
end

local function figure_pages(topic)
  local text, per_page = { panels.data(topic.panels) }, 3 * panel_rows
  for first = 1, #topic.panels, per_page do
    local last = math.min(first + per_page - 1, #topic.panels)
    text[#text + 1] = panels.script(topic.panels, first, last, panel_rows, topic.name)
  end
  return table.concat(text, "\n")
end

-- The whole script: terminal, tables, figures.
local function script(topics, sources, introduction)
  local text = { "set terminal pdfcairo size 21cm,29.7cm font 'Sans,6' fontscale 1 linewidth 0.6", "set output 'validate.pdf'" }
  text[#text + 1] = "unset border; unset tics; unset key; set xrange [0:1]; set yrange [0:1]; set margins 0,0,0,0"
  for _, page in ipairs(paginate(topics, sources, introduction)) do text[#text + 1] = page_script(page) end
  for _, topic in ipairs(topics) do
    if #topic.panels > 0 then text[#text + 1] = "reset\n" .. figure_pages(topic) end
  end
  return table.concat(text, "\n") .. "\n"
end

-- topics: { name =, problems =, panels = }; sources(problem) gives the text of its sources.
function pdf.write(topics, o, sources, introduction)
  local fine, why = files.write(o.out .. "/validate.gp", script(topics, sources, introduction))
  if not fine then return nil, why end
  why = plot.gnuplot(o.out, "load 'validate.gp'")
  return why == nil, why
end

return pdf
