[
  (block)
  (group)
  (arguments)
  (comment)
] @fold
