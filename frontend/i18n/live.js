// The words of everything but the scope, the timeline and the transport (live-scope.js): one file a language.

export {en} from './live-en.js';
export {zh} from './live-zh.js';
