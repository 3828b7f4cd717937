/** Terms and what is said about each. */

export function Terms({ all }: { all: readonly [string, string][] }) {
  return <dl class="sure">{all.map(([term, words]) => <div key={term}><dt>{term}</dt><dd>{words}</dd></div>)}</dl>;
}
