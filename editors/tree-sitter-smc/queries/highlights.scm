; No two patterns give one node different captures, because editors differ in which of them wins.

(comment) @comment
(string) @string
(number) @number
(steps) @number
(infinity) @number
(unit) @type
(boolean) @boolean

(keyword) @keyword
(clause) @keyword
(quantifier) @keyword.operator
(temporal ["F" "G" "X"] @keyword.operator)
(until ["U" "W" "R"] @keyword.operator)
(fold ["min" "max" "sum" "mean"] @function.builtin)

(declaration name: (identifier) @constant)
(setting name: (identifier) @property)
(member name: (identifier) @property)
(call function: (identifier) @function)

; `for "corridor.scn"`
(statement . (identifier) @keyword . (string) .)

; Words such as `circle`, `uniform` and `leave` are names elsewhere: `a in end`.
(call function: (word) @function)
((clause) . (word) @keyword)
((word) @keyword . [(identifier) (quantity) (string) (call) (member) (index)])
((word) @keyword . (operator "in"))
([(quantity) (identifier) (call) (group)] . (word) @keyword)
(declaration (delimiter "=") . (word) @keyword .)

(operator) @operator
(operator "in" @keyword.operator)
(delimiter) @punctuation.delimiter
";" @punctuation.delimiter
(setting "=" @punctuation.delimiter)
["(" ")" "[" "]" "{" "}"] @punctuation.bracket
