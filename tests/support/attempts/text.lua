-- Names that try to command the terminal, or to break out of their place in a file.
local function named(name, rest)
  return ('local s = hooke.scene { duration = 0.1, fps = 10, integrator = "leapfrog" }\n'
    .. 's:particle {}\ns:force("gravity", { label = "%s" })\ns:measure("%s", function() return 1 end)\n%s\nreturn s'):format(name,
    name, rest or "")
end

local escape = "\\27[2J\\27]0;x\\7\\155\\r\\8"

return {
  { "escapes in names, in the summary", scene = named(escape), hides = "[\27\7\8\r\155]", any = true },
  { "escapes in names, in the JSON summary", scene = named(escape), args = "--json", hides = "[\27\7\8\r\155]", any = true, json = true },
  { "escapes in an error", scene = 'error("' .. escape .. '")', hides = "[\27\7\8\r\155]", says = "hooke:" },
  { "escapes in what is printed", scene = 'print("' .. escape .. '") error("end")', hides = "[\27\7\8\r\155]", says = "end" },
  { "escapes in parameters' names and help", scene = 'param("a' .. escape .. '", "' .. escape .. '", "' .. escape .. '")',
    args = "--help", hides = "[\27\7\8\r\155]", any = true },
  { "escapes in a warning", hides = "[\27\7\8\r\155]", any = true,
    scene = named(escape, 's:force("gravity", { label = "x' .. escape .. '", from = 0, to = 1e-9 })') },
  { "escapes in the file's name", scene = "return 1", name = "\27[2J.lua", hides = "[\27\7\8\r\155]", says = "hooke:" },
  { "escapes in a plugin's name", scene = 'hooke.scene{}:force("' .. escape .. '")', hides = "[\27\7\8\r\155]", says = "hooke:" },
  { "escapes under explain", scene = named(escape), command = "explain", hides = "[\27\7\8\r\155]", any = true },
  { "escapes under stability", scene = named(escape), command = "stability", hides = "[\27\7\8\r\155]", any = true },
  { "bytes that are no UTF-8, in the JSON summary", scene = named("\\xff\\xc0\\x80\\xed\\xa0\\x80\\xf8x"), args = "--json",
    any = true, json = true },
  { "UTF-8 in the JSON summary", scene = named("Größe µ 力"), args = "--json", any = true, json = true, says = "Größe µ 力" },
  { "UTF-8 in the summary", scene = named("Größe µ 力"), any = true, says = "Größe µ 力" },
  { "a bidirectional override in a name", scene = named("\\u{202E}x\\u{2066}"), hides = "\u{202E}", any = true },
  { "commas, quotes and line breaks in measures.csv", args = "--out out", scene = named('a,\\"b\\"\\nc'), any = true,
    csv = 't,"a,""b""\nc"' },
  { "plain names in measures.csv", args = "--out out", scene = named("speed"), any = true, csv = "t,speed" },
}
