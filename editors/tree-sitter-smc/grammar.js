/// <reference types="tree-sitter-cli/dsl" />
// @ts-check
//
// One grammar for scenarios (.scn) and properties (.bltl).
//
// An item is a flat sequence of operands and of marks between them. The grammar knows which marks and words need an
// operand behind them, because an item does not end there; the scanner knows which lines go on with an item. Precedence
// is left out: no query needs it, and the language server has the full syntax tree.

const keywords = require('../keywords.json');

const INFIX = ['U', 'W', 'R'];
const PREFIX = ['F', 'G', 'X'];
const QUANTIFIERS = ['forall', 'exists'];
const FOLDS = ['min', 'max', 'sum', 'mean'];
const BOOLEANS = ['true', 'false'];

// Words that begin an item, with and without the name of what they declare.
const declaring = keywords.declares ?? keywords.items;
const beginning = keywords.items.filter((/** @type {string} */ word) => !declaring.includes(word));
// `in` is an operator, and `subject to` is one clause.
const clauses = keywords.continues.filter((/** @type {string} */ word) => !['in', 'subject'].includes(word));
const inner = (keywords.inner ?? []).filter((/** @type {string} */ word) => !QUANTIFIERS.includes(word));
// Words that are keywords where an operand can begin, and still may be names there.
const special = [...PREFIX, ...FOLDS, ...BOOLEANS, ...QUANTIFIERS, ...inner];

module.exports = grammar({
  name: 'smc',

  word: $ => $.identifier,

  extras: $ => [/[ \t\r\n\uFEFF]/, $.comment],

  externals: $ => [$._item_end, $.unit, $._point_unit, $._error],

  rules: {
    source_file: $ => repeat($._line),

    _line: $ => choice(seq($._item, choice($._item_end, ';')), ';'),

    block: $ => seq('{', repeat($._line), '}'),

    _item: $ => choice($.setting, $.declaration, $.statement),

    // `radius = 0.3 m`, also with a keyword as the name
    setting: $ => prec(2, seq(
      field('name', choice($.identifier, alias(choice(...keywords.items, ...special), $.identifier))),
      '=',
      $._body,
    )),

    // `agents crowd[12]: adult { … }`, `check P(safe) >= 0.9`
    declaration: $ => choice(
      // `heading from -60 deg to 60 deg by 15 deg`, `family confidence 95 %`
      seq(field('head', alias(choice(...beginning), $.keyword)), optional($.clause), $._body),
      seq(field('head', alias(choice(...beginning), $.keyword))),
      prec(1, seq(field('head', alias(choice(...declaring), $.keyword)), field('name', $.identifier), optional($._body))),
      prec(1, seq(
        field('head', alias(choice(...declaring), $.keyword)),
        field('name', alias(choice(...special), $.identifier)),
        choice($.block, seq(alias(choice(':', '='), $.delimiter), $._body)),
      )),
      seq(field('head', alias(choice(...declaring), $.keyword)), optional($._body)),
    ),

    // An update or a choice: `1/2: s = 1 | 1/2: s = 2`, `p: follow | 1 - p: ignore`
    statement: $ => $._body,

    _body: $ => choice($._closed, $._open),

    _closed: $ => choice(
      seq(optional($._marks), $._operand),
      seq($._closed, optional(seq(choice($._mark, $.clause, $.until), optional($._marks))), $._operand),
      seq($._open, optional($._marks), $._operand),
    ),

    // It ends with an operator over time. What follows is an operand, also if it has the name of a clause.
    _open: $ => seq(
      choice(
        optional($._marks),
        seq($._closed, optional(seq(choice($._mark, $.clause, $.until), optional($._marks)))),
        seq($._open, optional($._marks)),
      ),
      choice($.temporal, $.fold),
    ),

    _marks: $ => repeat1($._mark),

    _mark: $ => choice($.operator, $.delimiter),

    operator: _ => choice(
      '+', '-', '*', '/', '^',
      '==', '!=', '≠', '<=', '≤', '<', '>=', '≥', '>',
      '!', '¬', '&', '∧', '|', '∨', '=>', '⇒', '<=>', '⇔',
      '->', '--', '..', 'in',
    ),

    delimiter: _ => choice(',', ':', '='),

    clause: _ => choice(...clauses, prec.right(seq('subject', optional('to')))),

    _operand: $ => choice(
      $.quantity,
      $.steps,
      $.infinity,
      $.string,
      $.boolean,
      $.quantifier,
      $.block,
      $.group,
      $.list,
      $._reference,
    ),

    _reference: $ => choice($._name, $.call, $.member, $.index),

    _name: $ => choice($.identifier, alias(choice(...FOLDS), $.identifier), alias(choice(...inner), $.word)),

    call: $ => prec(3, seq(field('function', choice($._name, $.member)), $.arguments)),

    arguments: $ => seq('(', optional($._body), ')'),

    index: $ => prec(3, seq($._reference, '[', $._body, ']')),

    member: $ => prec(3, seq(
      choice($._reference, $.group, $.temporal),
      '.',
      field('name', choice($.identifier, alias(choice(...special), $.identifier))),
    )),

    // `(a | b)`, `(2, 1.5)`, `(20, 15) cm`
    group: $ => prec.right(seq('(', optional($._body), ')', optional(alias($._point_unit, $.unit)))),

    list: $ => seq('[', $._body, ']'),

    quantity: $ => prec.right(seq($.number, optional($.unit))),

    number: _ => /(\d+(\.\d+)?|\.\d+)([eE][+-]?\d+)?/,

    steps: _ => /#\d+/,

    infinity: _ => '∞',

    string: _ => /"(\\[^\n]|[^"\\\n])*"/,

    boolean: _ => choice(...BOOLEANS),

    quantifier: _ => choice(...QUANTIFIERS),

    // `F<=10 s`, `G[2 s, 5 s]`, `X`
    temporal: $ => prec.right(4, seq(choice(...PREFIX), optional($.bound))),

    until: $ => prec.right(4, seq(choice(...INFIX), optional($.bound))),

    // `min<=10 s`, `mean[4 s, 8 s]`
    fold: $ => prec(4, seq(choice(...FOLDS), $.bound)),

    bound: $ => prec.right(4, choice(
      seq(
        alias(choice('<=', '≤'), $.operator),
        optional(alias('-', $.operator)),
        choice($.quantity, $.steps, $.infinity, $.group, $.string, $._name, $.member),
      ),
      $.list,
    )),

    identifier: _ => /[\p{XID_Start}_][\p{XID_Continue}]*/u,

    comment: _ => token(choice(
      seq('//', /[^\n]*/),
      seq('/*', /[^*]*\*+([^/*][^*]*\*+)*/, '/'),
    )),
  },
});
