-- The glossary of the handbook, scripts/handbook/glossary.md: rows "| word, other word | what it is | see |".
local glossary = {}

-- { { words = { word }, text, see } } in the order of the page; path: of another page than the installation's.
function glossary.all(path)
  local list = {}
  local file = assert(io.open(path or hooke.library .. "/../handbook/glossary.md"))
  for line in file:lines() do
    local words, text, see = line:match("^| (.-) | (.-) | (.-) |$")
    if words and words ~= "word" then
      local entry = { words = {}, text = text, see = see }
      for word in words:gmatch("[^,]+") do entry.words[#entry.words + 1] = word:match("^%s*(.-)%s*$") end
      list[#list + 1] = entry
    end
  end
  file:close()
  return list
end

local function singular(word) return (word:lower():gsub("s$", "")) end

-- The entry of a word, in whatever case and number; nil: there is none.
function glossary.find(word)
  for _, entry in ipairs(glossary.all()) do
    for _, own in ipairs(entry.words) do
      if singular(own) == singular(word) then return entry end
    end
  end
end

function glossary.lines(entry)
  return { ("%s: %s"):format(table.concat(entry.words, ", "), entry.text), "  see " .. entry.see:gsub("`", "") }
end

return glossary
