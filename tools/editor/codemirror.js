// What the page uses of CodeMirror. tools/page_bundle.py makes frontend/vendor/codemirror.js of it.

export {autocompletion, completionKeymap, startCompletion} from '@codemirror/autocomplete';
export {defaultKeymap, history, historyKeymap, indentWithTab, undo} from '@codemirror/commands';
export {json} from '@codemirror/lang-json';
export {yaml} from '@codemirror/lang-yaml';
export {bracketMatching, HighlightStyle, indentUnit, syntaxHighlighting} from '@codemirror/language';
export {highlightSelectionMatches, search, searchKeymap} from '@codemirror/search';
export {Compartment, EditorState, RangeSetBuilder, StateEffect, StateField} from '@codemirror/state';
export {
  Decoration,
  drawSelection,
  EditorView,
  gutterLineClass,
  GutterMarker,
  highlightActiveLine,
  highlightActiveLineGutter,
  keymap,
  lineNumbers,
  MatchDecorator,
  ViewPlugin,
  WidgetType,
} from '@codemirror/view';
export {tags} from '@lezer/highlight';
