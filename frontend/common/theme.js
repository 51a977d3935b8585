// Loaded before anything is drawn, so that a page opened in the dark never flashes. Light or dark as the system has it,
// until the button says otherwise.
(() => {
  const system = matchMedia('(prefers-color-scheme: dark)');
  const kept = () => {
    try {
      return localStorage.getItem('theme');
    } catch {
      return null;
    }
  };
  const apply = () => {
    const theme = kept() ?? (system.matches ? 'dark' : 'light');
    if (document.documentElement.dataset.theme === theme) return;
    document.documentElement.dataset.theme = theme;
    document.querySelector('meta[name=theme-color]')?.setAttribute('content', theme === 'dark' ? '#0e1216' : '#f6f5f1');
    dispatchEvent(new CustomEvent('theme', {detail: theme}));
  };
  window.theme = {
    get now() {
      return document.documentElement.dataset.theme === 'dark' ? 'dark' : 'light';
    },
    toggle() {
      const next = this.now === 'dark' ? 'light' : 'dark';
      try {
        // The system's own theme again: follow the system from here on.
        if (next === (system.matches ? 'dark' : 'light')) localStorage.removeItem('theme');
        else localStorage.setItem('theme', next);
      } catch {
        /* private windows keep nothing */
      }
      apply();
      if (this.now !== next) {
        document.documentElement.dataset.theme = next;
        dispatchEvent(new CustomEvent('theme', {detail: next}));
      }
    },
  };
  system.addEventListener('change', apply);
  apply();
})();
