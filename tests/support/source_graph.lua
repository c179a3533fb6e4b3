-- Files of sources as a graph: arrows { from =, to =, by = } read from #include, require and symbols of object files, its
-- strongly connected components (Tarjan 1972), and a text parted into code and comments. A .c and the .h of the same
-- name are one file of the graph.
local source_graph = {}

-- ---- circles ----

local function file_of(path) return (path:gsub("%.[ch]$", "")) end

-- { [file] = { [file] = by } }, and the files in a fixed order.
function source_graph.graph_of(arrows)
  local graph, files = {}, {}
  local function add(file)
    if not graph[file] then graph[file], files[#files + 1] = {}, file end
  end
  for _, a in ipairs(arrows) do
    local from, to = file_of(a.from), file_of(a.to)
    add(from)
    add(to)
    if from ~= to then graph[from][to] = graph[from][to] or a.by end
  end
  table.sort(files)
  return graph, files
end

-- Strongly connected components of more than one file.
function source_graph.components(graph, files)
  local index, low, on_stack, stack, count, found = {}, {}, {}, {}, 0, {}
  local function visit(v)
    count = count + 1
    index[v], low[v], on_stack[v], stack[#stack + 1] = count, count, true, v
    for w in pairs(graph[v]) do
      if not index[w] then
        visit(w)
        low[v] = math.min(low[v], low[w])
      elseif on_stack[w] then low[v] = math.min(low[v], index[w]) end
    end
    if low[v] < index[v] then return end
    local members = {}
    repeat
      local w = table.remove(stack)
      on_stack[w], members[#members + 1] = nil, w
    until w == v
    table.sort(members)
    if #members > 1 then found[#found + 1] = members end
  end
  for _, v in ipairs(files) do
    if not index[v] then visit(v) end
  end
  return found
end

-- The shortest way from a file back to itself, with what each arrow is made of.
function source_graph.circle_from(graph, start)
  local before, queue = {}, { start }
  for _, v in ipairs(queue) do
    for w in pairs(graph[v]) do
      if w == start then
        local way = ("%s (%s)"):format(w, graph[v][w])
        while v ~= start do
          way = ("%s (%s) -> %s"):format(v, graph[before[v]][v], way)
          v = before[v]
        end
        return start .. " -> " .. way
      elseif not before[w] then before[w], queue[#queue + 1] = v, w end
    end
  end
end

-- ---- reading ----

local stops = { ['"'] = '["\\]', ["'"] = "['\\]" } -- a quote's end, or what hides one

local function part(text)
  local code, comment, at = {}, {}, 1
  local function blank(s) return (s:gsub("[^\n]", " ")) end
  while at <= #text do
    local start, _, opening = text:find('(["\'/])', at)
    if not start then break end
    local piece
    if opening == "/" then
      local two = text:sub(start, start + 1)
      piece = two == "/*" and text:sub(start, select(2, text:find("*/", start + 2, true)) or -1)
        or two == "//" and text:match("^[^\n]*", start)
    end
    local before = text:sub(at, start - 1)
    local is_comment = piece and true or false
    if not piece and opening ~= "/" then
      local stop = text:find(stops[opening], start + 1)
      while stop and text:sub(stop, stop) == "\\" do stop = text:find(stops[opening], stop + 2) end
      piece = text:sub(start, stop or #text)
    end
    piece = piece or opening
    code[#code + 1] = before .. (is_comment and blank(piece) or piece)
    comment[#comment + 1] = blank(before) .. (is_comment and piece or blank(piece))
    at = start + #piece
  end
  code[#code + 1] = text:sub(at)
  return table.concat(code), table.concat(comment)
end

local parts = {} -- by text: several checks ask for the same

-- The text's code, strings included, and its comments, each with the line breaks of the whole.
function source_graph.split(text)
  parts[text] = parts[text] or { part(text) }
  return table.unpack(parts[text])
end

function source_graph.includes_of(path, text, exists)
  local arrows = {}
  for name in ("\n" .. text):gmatch('\n[ \t]*#[ \t]*include[ \t]*"([^"]+)"') do
    local beside = path:match("^(.*/)") .. name
    arrows[#arrows + 1] = { from = path, to = exists[name] and name or exists[beside] and beside or name, by = "include" }
  end
  return arrows
end

-- Lines of `nm -A -g`, as arrows between sources. A plugin takes symbols from plugins/, everything else from core/.
function source_graph.symbols_of(lines, source_of)
  local definer, taken, arrows = { core = {}, plugins = {} }, {}, {}
  for line in lines:gmatch("[^\n]+") do
    local object, kind, symbol = line:match("^(.-):%s*%x*%s+(%a)%s+(%S+)$")
    local source = object and source_of(object)
    local top = source and source:match("^%w+")
    if source and (kind == "U" or kind == "w" or kind == "v") then
      taken[#taken + 1] = { from = source, symbol = symbol, side = top == "plugins" and "plugins" or "core" }
    elseif source and kind:find("[%uiu]") and (top == "core" or source:find("^plugins/common/")) then
      definer[top][symbol] = source
    end
  end
  for _, t in ipairs(taken) do
    local to = definer[t.side][t.symbol]
    if to and to ~= t.from then arrows[#arrows + 1] = { from = t.from, to = to, by = t.symbol } end
  end
  return arrows
end

function source_graph.requires_of(path, text, exists)
  local arrows = {}
  text = text:gsub("%-%-[^\n]*", "")
  for name in text:gmatch("require%s*%(?%s*[\"']([%w_.%-]+)[\"']") do
    local file = name:gsub("%.", "/")
    for _, to in ipairs { ("tools/%s.lua"):format(file), ("tools/native/%s.c"):format(file),
      ("scripts/lib/%s.lua"):format(file) } do
      if exists[to] then arrows[#arrows + 1] = { from = path, to = to, by = "require" } end
    end
  end
  return arrows
end

return source_graph
