-- References to figures, tables, equations and sections, which LaTeX or Typst number.
local names = { fig = "Fig.", tbl = "Table", eq = "Eq.", sec = "Sect." }

local function raw(text)
  return pandoc.RawInline(FORMAT, text)
end

function Cite(cite)
  local made = pandoc.Inlines {}
  for place, one in ipairs(cite.citations) do
    local kind = one.id:match("^(%a+):")
    if not names[kind] then return nil end
    local number = FORMAT == "latex" and "\\ref{" .. one.id .. "}"
      or "#ref(<" .. one.id .. ">, supplement: none)"
    made:insert(pandoc.Str((place > 1 and ", " or "") .. names[kind] .. "\u{a0}"))
    made:insert(raw(kind == "eq" and "(" .. number .. ")" or number))
  end
  return made
end

-- $$ ... $$ {#eq:one} is an equation with a number.
function Inlines(inlines)
  for place = #inlines, 3, -1 do
    local str, formula = inlines[place], inlines[place - 2]
    local label = str and str.t == "Str" and str.text:match("^{#(eq:[%w:.-]+)}$")
    if label and formula.t == "Math" then
      inlines:remove(place)
      inlines:remove(place - 1)
      if FORMAT == "latex" then
        local text = formula.text:gsub("^%s+", ""):gsub("%s+$", "")
        inlines[place - 2] =
          raw("\\begin{equation}\\label{" .. label .. "}\n" .. text .. "\n\\end{equation}")
      else
        inlines:insert(place - 1, raw(" <" .. label .. ">]"))
        inlines:insert(place - 2, raw('#[#set math.equation(numbering: "(1)")\n'))
      end
    end
  end
  return inlines
end

-- A line of Typst does not break in N/mm.
function Str(str)
  return FORMAT == "typst" and pandoc.Str(str.text:gsub("(%a)/(%a)", "%1/\u{2060}%2")) or nil
end
