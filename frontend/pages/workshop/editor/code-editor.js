// The editor with line numbers, colours, undo and search: CodeMirror, from frontend/vendor, which set-up makes.

import {t} from '../../../i18n/words.js';
import {errorLine} from './error-line.js';

/** @import * as service from '../../../types/service.js' */
/** @import {CompletionContext, CompletionResult} from '@codemirror/autocomplete' */
/** @import {EditorState, RangeSetBuilder, Text, Transaction} from '@codemirror/state' */
/** @import {DecorationSet, EditorView, GutterMarker, ViewUpdate} from '@codemirror/view' */
/** @import {Editor, EditorEvents, TextError} from '../types.js' */

/** @typedef {typeof import('../../../../tools/editor/codemirror.js')} CodeMirror */
/** @typedef {{errors: readonly TextError[], apply: (error: TextError) => void}} Shown */

const FUNCTIONS =
  'a?(?:sin|cos|tan)h?|atan2|exp|log|sqrt|abs|sign|min|max|clip|heaviside|step|floor|where|spow|backlash|interp' +
  '|deadzone|play|satplay|boucwen';
const CALLS = new RegExp(`\\b(?:${FUNCTIONS})(?=\\()|(?<![\\w.])\\d+\\.?\\d*(?:e[+-]?\\d+)?(?![\\w.])`, 'g');

/**
 * @param {CodeMirror} cm
 * @param {string} text
 * @param {EditorEvents} events
 * @returns {Editor}
 */
export function codeEditor(cm, text, events) {
  /** @type {readonly string[]} */
  let words = [];
  const lint = lintField(cm);
  const marks = marksField(cm);
  const language = new cm.Compartment();
  const languageOf = (/** @type {string} */ content) => (content.trimStart().startsWith('{') ? cm.json() : cm.yaml());
  /** @param {() => void} act */
  const command = (act) => () => {
    act();
    return true;
  };
  const view = new cm.EditorView({
    state: stateOf(text),
  });

  /** @param {string} content */
  function stateOf(content) {
    return cm.EditorState.create({
      doc: content,
      extensions: [
        cm.lineNumbers(),
        cm.highlightActiveLine(),
        cm.highlightActiveLineGutter(),
        cm.history(),
        cm.drawSelection(),
        cm.bracketMatching(),
        cm.highlightSelectionMatches(),
        cm.search({top: true}),
        cm.indentUnit.of('  '),
        cm.EditorState.phrases.of(phrases()),
        language.of(languageOf(content)),
        cm.syntaxHighlighting(colours(cm)),
        callColours(cm),
        cm.autocompletion({override: [completions(() => words)], icons: false}),
        lint.extension,
        marks.extension,
        cm.EditorView.contentAttributes.of({
          'aria-label': t('page.workshop.editor'),
          spellcheck: 'false',
          tabindex: '0',
        }),
        cm.keymap.of([
          {key: 'Mod-s', run: command(events.save), preventDefault: true},
          {key: 'Mod-Enter', run: command(events.live)},
          {key: 'Alt-Enter', run: command(events.fix)},
          {key: 'F8', run: command(events.next)},
          ...cm.defaultKeymap,
          ...cm.historyKeymap,
          ...cm.searchKeymap,
          ...cm.completionKeymap,
        ]),
        cm.EditorView.updateListener.of((/** @type {ViewUpdate} */ update) => {
          if (update.docChanged) events.change(update.state.doc.toString());
          if (update.docChanged || update.selectionSet) {
            const {head} = update.state.selection.main;
            const line = update.state.doc.lineAt(head);
            events.cursor(line.number, head - line.from + 1);
          }
        }),
      ],
    });
  }

  /** @param {service.TextPlace} place */
  const range = (place) => rangeIn(view.state.doc, place);

  return {
    element: view.dom,
    text: () => view.state.doc.toString(),
    setText(next, asEdit = false) {
      if (asEdit) view.dispatch({changes: {from: 0, to: view.state.doc.length, insert: next}});
      else view.setState(stateOf(next));
      view.dispatch({effects: language.reconfigure(languageOf(next))});
    },
    showErrors: (errors, apply) => view.dispatch({effects: lint.show.of({errors, apply})}),
    replace(place, by) {
      const {from, to} = range(place);
      view.dispatch({
        changes: {from, to, insert: by},
        selection: {anchor: from + by.length},
        userEvent: 'input.fix',
        scrollIntoView: true,
      });
      view.focus();
    },
    select(place) {
      const {from, to} = range(place);
      view.dispatch({selection: {anchor: from, head: to}, effects: cm.EditorView.scrollIntoView(from, {y: 'center'})});
      view.focus();
    },
    names(next) {
      words = next;
    },
    mark(lines) {
      const last = Math.min(lines.at(-1) ?? 0, view.state.doc.lines);
      const seen = last > 0 ? [cm.EditorView.scrollIntoView(view.state.doc.line(last).from, {y: 'end'})] : [];
      view.dispatch({effects: [marks.show.of(lines), ...seen]});
    },
    undo: () => cm.undo(view),
  };
}

/** @param {Text} doc @param {service.TextPlace} place */
function rangeIn(doc, {line, column, length}) {
  const {from} = doc.line(Math.min(Math.max(1, line), doc.lines));
  const start = Math.min(doc.length, from + column - 1);
  return {from: start, to: Math.min(doc.length, start + length)};
}

/** Words of CodeMirror's own panels in the page's language. */
const phrases = () => ({
  Find: t('page.workshop.find'),
  Replace: t('page.workshop.find.by'),
  next: t('page.workshop.find.next'),
  previous: t('page.workshop.find.previous'),
  all: t('page.workshop.find.all'),
  'match case': t('page.workshop.find.case'),
  'by word': t('page.workshop.find.word'),
  regexp: t('page.workshop.find.pattern'),
  replace: t('page.workshop.find.replace'),
  'replace all': t('page.workshop.find.replace-all'),
  close: t('page.workshop.close'),
  Completions: t('page.workshop.names'),
});

/** @param {CodeMirror} cm */
function colours(cm) {
  const {tags} = cm;
  return cm.HighlightStyle.define([
    {tag: [tags.propertyName, tags.definition(tags.propertyName)], class: 'key'},
    {tag: [tags.number, tags.bool, tags.null], class: 'number'},
    {tag: tags.comment, class: 'comment'},
  ]);
}

/** Numbers and functions in expressions, which are text for YAML. @param {CodeMirror} cm */
function callColours(cm) {
  const decorator = new cm.MatchDecorator({
    regexp: CALLS,
    decoration: (match) => cm.Decoration.mark({class: /^\d/.test(match[0]) ? 'number' : 'call'}),
  });
  return cm.ViewPlugin.define(
    (/** @type {EditorView} */ view) => ({
      decorations: decorator.createDeco(view),
      /** @param {ViewUpdate} update */
      update(update) {
        this.decorations = decorator.updateDeco(update, this.decorations);
      },
    }),
    {decorations: (plugin) => plugin.decorations},
  );
}

/**
 * @param {() => readonly string[]} words
 * @returns {(context: CompletionContext) => CompletionResult | null}
 */
function completions(words) {
  return (context) => {
    const word = context.matchBefore(/[\p{L}_][\p{L}\p{N}_]*/u);
    if (!word && !context.explicit) return null;
    if (word && !context.explicit && word.to - word.from < 2) return null;
    return {
      from: word ? word.from : context.pos,
      options: words().map((label) => ({label})),
      validFor: /^[\p{L}\p{N}_]*$/u,
    };
  };
}

/**
 * Errors: characters underlined, the number of the line marked, the remedy under the line.
 * @param {CodeMirror} cm
 */
function lintField(cm) {
  /** @type {import('@codemirror/state').StateEffectType<Shown>} */
  const show = cm.StateEffect.define();
  class Remedy extends cm.WidgetType {
    /** @param {TextError} error @param {() => void} apply */
    constructor(error, apply) {
      super();
      this.error = error;
      this.apply = apply;
    }
    /** @param {Remedy} other */
    eq(other) {
      return JSON.stringify(other.error) === JSON.stringify(this.error);
    }
    toDOM() {
      return errorLine(this.error, this.apply);
    }
    ignoreEvent() {
      return true;
    }
  }
  class Wrong extends cm.GutterMarker {
    elementClass = 'wrong-line';
  }
  const wrong = new Wrong();
  const field = cm.StateField.define({
    create: () => cm.Decoration.none,
    /** @param {DecorationSet} shown @param {Transaction} transaction */
    update(shown, transaction) {
      let next = shown.map(transaction.changes);
      for (const effect of transaction.effects)
        if (effect.is(show)) next = decorations(transaction.state.doc, effect.value);
      return next;
    },
    provide: (own) => [
      cm.EditorView.decorations.from(own),
      cm.gutterLineClass.compute([own], (/** @type {EditorState} */ state) => {
        /** @type {RangeSetBuilder<GutterMarker>} */
        const builder = new cm.RangeSetBuilder();
        const lines = new Set();
        for (const iterator = state.field(own).iter(); iterator.value; iterator.next())
          if (iterator.value.spec.wrong) lines.add(state.doc.lineAt(iterator.from).from);
        for (const from of [...lines].sort((a, b) => a - b)) builder.add(from, from, wrong);
        return builder.finish();
      }),
    ],
  });

  /** @param {Text} doc @param {Shown} shown */
  function decorations(doc, {errors, apply}) {
    const parts = errors.flatMap((error) => {
      const {from, to} = rangeIn(doc, error.place);
      const line = doc.lineAt(from);
      const end = Math.max(to, Math.min(from + 1, line.to));
      const under = cm.Decoration.mark({class: `wavy ${error.severity}`, wrong: error.severity === 'error'});
      const widget = cm.Decoration.widget({widget: new Remedy(error, () => apply(error)), block: true, side: 1});
      return [...(end > from ? [under.range(from, end)] : []), widget.range(doc.lineAt(Math.min(end, line.to)).to)];
    });
    return cm.Decoration.set(parts, true);
  }
  return {show, extension: field};
}

/** Lines that are new: green. @param {CodeMirror} cm */
function marksField(cm) {
  /** @type {import('@codemirror/state').StateEffectType<readonly number[]>} */
  const show = cm.StateEffect.define();
  const fresh = cm.Decoration.line({class: 'new-line'});
  const field = cm.StateField.define({
    create: () => cm.Decoration.none,
    /** @param {DecorationSet} shown @param {Transaction} transaction */
    update(shown, transaction) {
      let next = shown.map(transaction.changes);
      for (const effect of transaction.effects)
        if (effect.is(show))
          next = cm.Decoration.set(
            effect.value
              .filter((line) => line <= transaction.state.doc.lines)
              .map((line) => fresh.range(transaction.state.doc.line(line).from)),
            true,
          );
      return next;
    },
    provide: (own) => cm.EditorView.decorations.from(own),
  });
  return {show, extension: field};
}
